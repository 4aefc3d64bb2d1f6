// The reference: an unbiased path tracer of the same scenes. It shares with the renderer the scene and the optics of a
// smooth surface, and no approximation.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "image/picture.h"
#include "reference/guiding.h"
#include "scene/scene.h"

namespace alabaster {

struct ReferenceProgress {
  double samples = 0;        // per pixel, done so far
  double noise = 0;          // relative standard error as of the last complete pass; 0 before there is one
  double share = 0;          // of the work, 0..1, by samples or, with a noise target, by the noise
  double seconds = 0;        // since the start of this run
  double seconds_left = -1;  // an estimate; negative where there is none yet
};

struct ReferenceOptions {
  int width = 640, height = 480;
  std::string camera;  // empty: the scene's first
  int samples = 64;    // per pixel; with a noise target the most that are taken
  double noise =
      0;  // stop when the standard error of the object's pixels falls below this share of their mean; 0: never
  std::uint64_t seed = 0;
  int threads = 0;                                      // 0: all
  bool multiple = true, single = true, surface = true;  // components; R, G, B is the sum of the chosen ones
  // Whether lamps are looked for through refracting surfaces; the same picture either way, but for its noise.
  Guiding guiding = Guiding::automatic;
  // Where the run keeps its sums: written every `state_seconds` and when it is stopped, removed when it is done unless
  // `keep_state`. Empty: nowhere.
  std::string state_path;
  double state_seconds = 30;
  bool resume = false;      // go on from state_path if it is there
  bool keep_state = false;  // so that a later run can add samples
  // Called now and then from the rendering threads, one at a time; false stops after the pass under way (then the state
  // is kept and the picture holds what is done).
  std::function<bool(const ReferenceProgress&)> progress;
};

/// Renders `scene`. Channels, all means over the pixel's box-filtered samples: R, G, B (the sum of the chosen layers),
/// multiple.*, single.*, surface.* (see Layer in paths.h for what is booked where), the variance of the pixel mean
/// ((W/m^2/sr)^2) of the sum in variance.R/G/B, of the sum less surface in variance.subsurface.* and of each chosen
/// layer in variance.multiple.*, variance.single.* and variance.surface.* (layers of one path are not independent:
/// these do not add up), object.Y (share of the samples whose first hit is translucent), and of the ray through the
/// pixel's centre N.* (outward normal of the first surface, world space) and Z (its distance from the eye, m; 0 where
/// nothing is hit). Attributes: samplesPerPixel, seed, camera, scene, sceneFingerprint, seconds, threads,
/// eventsPerSample, cappedPaths and leakedPaths (how many; paths.h), noise. The result depends on the scene, the size,
/// the seed and the number of samples alone: not on threads, interruptions or their place. Throws UserError (no such
/// camera, a state file of another scene, an impossible option).
Picture render_reference(const Scene& scene, const ReferenceOptions& options);

/// Adds parts of one picture that were rendered with different seeds, weighted by their samples; the variances are
/// those of all samples taken together (T. Chan, G. Golub, R. LeVeque, 1979). `names` are the files' names, for
/// messages. Throws UserError where the parts are not of one scene, camera and size, or share a seed.
Picture merge(const std::vector<Picture>& parts, const std::vector<std::string>& names);

}  // namespace alabaster

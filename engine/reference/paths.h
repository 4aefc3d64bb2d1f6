// One path of light, followed backwards from the camera.
#pragma once

#include <glm/glm.hpp>

#include "reference/random.h"
#include "reference/world.h"

namespace alabaster {

/// Where a camera path's radiance is booked.
/// `surface`: it never entered a translucent object: mirrored by one, or an opaque or emissive mesh or the environment
/// seen directly. Everything behind a first hit that is not translucent is here too, whatever it went through later.
/// `single`: entered one object once, and was scattered in it at most once (so what shines straight through is here).
/// `multiple`: the rest: two or more scatterings, several visits to objects, or a mirror before the first entry.
enum class Layer { multiple = 0, single = 1, surface = 2 };
constexpr std::size_t layer_count = 3;

struct PathSample {
  glm::vec3 radiance[layer_count] = {glm::vec3(0), glm::vec3(0), glm::vec3(0)};  // W/m^2/sr
  bool on_object = false;                                                        // the first hit is translucent
  std::uint64_t events = 0;                                                      // scatterings and surfaces met
  bool capped = false;                                                           // the path was cut off at most_events
  int leaks = 0;  // escapes that met no surface on the way out: rounding at edges, or a mesh with holes
};

/// Paths are ended by Russian roulette; this cap exists so that a lossless closed scene cannot hang. It is counted.
constexpr std::uint64_t most_events = 1000000;

/// Follows one camera ray. Unbiased in each channel: flights are sampled in one channel picked for the path, and the
/// result is weighted with the density that the whole path has on average over the three picks (one-sample MIS over
/// wavelengths, A. Wilkie et al., "Hero Wavelength Spectral Sampling", 2014; for null collisions B. Miller et al., "A
/// null-scattering path integral formulation of light transport", 2019). Radiance is followed as L/n^2, which a smooth
/// surface's Fresnel factors alone change; emission inside an object of index n is divided by n^2 when it is picked up.
PathSample trace_path(const World& world, glm::vec3 origin, glm::vec3 direction, const Inside& camera_inside,
                      Random& random);

}  // namespace alabaster

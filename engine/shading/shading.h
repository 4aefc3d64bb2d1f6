// The picture of a lit scene: what each pixel sees, the surface query on translucent objects, plain shading elsewhere.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "domain/grid_frame.h"
#include "image/picture.h"
#include "lighting/lighting.h"
#include "shading/gather_exit.h"
#include "shading/single.h"
#include "shading/straight.h"
#include "shared/shading.h"

namespace alabaster {

enum class Exit { report, as_printed };  // radiance leaves with F_t / eta^2, or with F_t (Eq. 14 as printed)

/// What the solver knows of one translucent object.
struct TranslucentSurface {
  int object = 0;  // index in Scene::objects
  // 3D rgba, sampled trilinearly, rgb in W/m^2, for the two sides of a thin part (domain/facet_class.glsl); the same
  // image twice where that does not matter.
  const gpu::Image* fluence[2] = {nullptr, nullptr};  // phi on the surface
  // Gamma_s of the cells' facets. Not of the pixel: phi knows no light finer than a cell, and the pixel's Gamma_s came
  // out no closer to the path tracer on any grid tried.
  const gpu::Image* gamma_s[2] = {nullptr, nullptr};
  GridFrame frame;                           // of all; texel (i, j, k) is at origin + h (i + 0.5, ...)
  const GatherExit* gather = nullptr;        // where set, light leaves by it and not by the query
  const SingleScattering* single = nullptr;  // where set, it is drawn by itself and taken off the query
  const Straight* straight = nullptr;        // where set, what lies behind is seen straight through
};

struct Frame {
  glm::ivec2 size{640, 480};  // pixels
  int samples = 4;            // a pixel: 1, 4, 9, 16 or 25, on a regular grid
};

struct ShadedPicture {
  /// R, G, B = multiple + single + surface. multiple.*: light from inside, of the object itself or of one that it
  /// mirrors; single.*: what of it was scattered once and not mirrored, where that is computed by itself, and what is
  /// seen straight through the object (without the layer, `multiple` has both);
  /// surface.*: opaque and emissive objects, background, and what of them translucent objects mirror. fluence.*,
  /// gamma_s.*: W/m^2, mean over the pixel's translucent part, 0 without one. N.X, N.Y, N.Z: unit world normal, and Z:
  /// distance from the eye in metres, both means over what the pixel sees, 0 where it sees nothing. object.Y: share of
  /// the pixel that is translucent.
  Picture picture;
  std::size_t negative_pixels = 0;  // the query's bracket was negative in a channel and was set to 0
  double negative_share = 0;        // of the pixels that see translucent objects
};

class Reflection;

class Shading {
 public:
  explicit Shading(gpu::Context& context);
  ~Shading();

  /// Starts to make the passes that pictures of a scene will need, as a driver takes its time for them: `gather`:
  /// surfaces have one, `straight`: they have that.
  void begin(const Scene& scene, bool gather, bool straight) const;

  struct Input {
    const Scene& scene;
    const SceneMeshes& meshes;
    const Lighting& lighting;                  // its shadow maps drawn
    std::vector<TranslucentSurface> surfaces;  // translucent objects that are not listed stay black
    Camera camera;
    Frame frame;
    Exit exit = Exit::report;
    int rough_rays = 4;  // mirrored rays a sample of the picture where a surface is rough, and as many towards lights
    int mirrorings = 2;  // that are followed; what is mirrored once more is taken to see the environment
  };
  /// Draws the picture (stages "visibility", "plain", "translucent", "glow", "gathered", "single", "straight",
  /// "reflection") and fetches it. Throws
  /// UserError for a frame that makes no sense.
  ShadedPicture shade(const Input& input) const;

 private:
  void draw_visible(const Input& input, const glm::mat4& matrix, const gpu::Targets& targets) const;
  /// Counts the places that it wants light at before it returns; needs the visible triangles.
  void record_plain(gpu::Commands& commands, const Input& input, const CameraRays& rays,
                    const gpu::Bindings& shared) const;
  struct Single {
    const Input& input;
    const TranslucentSurface& surface;
    TranslucentPush push;
    glm::uvec2 extent;  // pixels
    gpu::Bindings bindings;
  };
  void record_single(gpu::Commands& commands, Single single) const;
  const gpu::Pass& gathered() const;  // made when first wanted

  gpu::Context& context_;
  gpu::Sampler linear_, nearest_;
  gpu::RasterPass visibility_;
  gpu::Pass places_[2], plain_, translucent_;             // places: counted, written
  mutable std::unique_ptr<gpu::Pass> gathered_, single_;  // made when first wanted
  std::unique_ptr<Reflection> reflection_;
};

}  // namespace alabaster

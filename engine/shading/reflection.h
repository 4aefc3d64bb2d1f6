// What translucent objects mirror: area lights, opaque and translucent objects and the environment, by rays through the
// tree of lighting/ray_tree.h.
#pragma once

#include <map>
#include <tuple>

#include "gpu/commands.h"
#include "shading/shading.h"
#include "shared/reflection.h"

namespace alabaster {

/// The scene as mirrored rays meet it, for one picture; must live until the commands have run.
struct MirroredScene {
  gpu::Buffer objects, emitters, lobes;
  std::uint32_t emitter_count = 0;
  gpu::Image glow;          // of all surfaces that are solved, two slabs each along z
  std::vector<int> glow_z;  // texels, where the first slab of each of Input::surfaces starts
};

class Reflection {
 public:
  explicit Reflection(gpu::Context& context);

  /// Starts to make what record() or record_straight() of this scene will need; `listed`: with a list of open pixels.
  void begin(const Scene& scene) const;
  void begin_straight(const Scene& scene, bool listed) const;

  MirroredScene prepare(const Shading::Input& input) const;

  /// Fills the glow image (stage "glow").
  void record_glow(gpu::Commands& commands, const Shading::Input& input, const MirroredScene& mirrored) const;

  /// Adds what `surface` mirrors to the images "multiple" and "surface" of `shared`, the bindings of
  /// shading/visible.glsl (stage "reflection"). `extent` covers the rectangle from `corner` on, pixels.
  struct Target {
    const TranslucentSurface& surface;
    CameraRays camera;
    glm::uvec2 corner, extent;
    const gpu::Bindings& shared;
  };
  void record(gpu::Commands& commands, const Shading::Input& input, const MirroredScene& mirrored,
              const Target& target) const;

  /// Adds what is seen straight through `surface` to "multiple" and "single" (stage "straight"), where set at the
  /// pixels that shading/gathered.comp lists in `open`.
  void record_straight(gpu::Commands& commands, const Shading::Input& input, const MirroredScene& mirrored,
                       const Target& target, const gpu::Buffer* open) const;

 private:
  ReflectionPush push(const Shading::Input& input, const MirroredScene& mirrored, const Target& target) const;
  gpu::Bindings bindings(const Shading::Input& input, const MirroredScene& mirrored, const Target& target) const;
  gpu::Context& context_;
  gpu::Sampler linear_;
  gpu::Pass glow_;
  /// Without what the scene has no use for; the first call starts to make it.
  const gpu::Pass& pass(const char* shader, const Scene& scene, bool listed) const;
  using Variant = std::tuple<std::string, bool, bool, bool>;  // listed, rough, uniform sky
  mutable std::map<Variant, std::unique_ptr<gpu::Pass>> passes_;
};

}  // namespace alabaster

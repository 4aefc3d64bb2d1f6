// Scenes in which nothing but mirrored light comes from the translucent object: what goes in is absorbed.
#pragma once

#include "compare/compare.h"
#include "reference/reference.h"
#include "shading/shading.h"
#include "support/lit_scene.h"

namespace alabaster {

inline void blacken(Scene& scene) {
  for (Object& object : scene.objects)
    if (object.role == Role::translucent) {
      object.medium = {};
      object.medium.homogeneous.sigma_a = glm::dvec3(1e9);
    }
}

/// The scene's picture with objects that are black inside.
inline Picture mirrored_picture(gpu::Context& context, const Scene& scene, const Frame& frame, int mirrorings = 2,
                                int rough_rays = 4) {
  const LitScene lit(context, scene, {64, 0, 512});
  const gpu::Image black = gpu::image3d(context, {2, 2, 2}, VK_FORMAT_R32G32B32A32_SFLOAT, "black");
  gpu::upload(context, black, std::vector<glm::vec4>(8, glm::vec4(0)));
  Shading::Input input{lit.scene, lit.meshes, lit.lighting, {}, scene.cameras.at(0), frame};
  input.mirrorings = mirrorings;
  input.rough_rays = rough_rays;
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    if (scene.objects[i].role == Role::translucent)
      input.surfaces.push_back(
          {static_cast<int>(i), {&black, &black}, {&black, &black}, GridFrame{{2, 2, 2}, 1, {-1, -1, -1}}});
  return Shading(context).shade(input).picture;
}

/// Means over blocks of `factor` x `factor` pixels.
inline Picture coarser(const Picture& fine, int factor) {
  Picture coarse{fine.width / factor, fine.height / factor, {}, {}};
  for (const auto& [name, values] : fine.channels) {
    std::vector<float>& plane = coarse.plane(name);
    for (int y = 0; y < coarse.height * factor; ++y)
      for (int x = 0; x < coarse.width * factor; ++x)
        plane[static_cast<std::size_t>(y / factor * coarse.width + x / factor)] +=
            values[static_cast<std::size_t>(y * fine.width + x)] / static_cast<float>(factor * factor);
  }
  return coarse;
}

inline Picture mirrored_reference(const Scene& scene, const Frame& frame, int samples) {
  ReferenceOptions options;
  options.width = frame.size.x;
  options.height = frame.size.y;
  options.samples = samples;
  return render_reference(scene, options);
}

}  // namespace alabaster

// What a ray meets in a scene, for passes that trace rays without ray-tracing hardware: a bounding volume hierarchy,
// built on the CPU, walked in compute by lighting/ray_tree.glsl.
#pragma once

#include "gpu/pass.h"
#include "scene/scene.h"
#include "shared/ray_tree.h"

namespace alabaster {

struct RayTree {
  std::vector<RayNode> nodes;          // none where there are no triangles
  std::vector<RayTriangle> triangles;  // in the order of the leaves
};

/// By Embree's builder (surface area heuristic). Translucent objects are closed: met from outside only.
RayTree make_ray_tree(const Scene& scene);

/// The twin of the walk in lighting/ray_tree.glsl: the nearest triangle between `near` and `far`, m.
RayHit trace(const RayTree& tree, glm::vec3 origin, glm::vec3 direction, float near = 0, float far = INFINITY);

/// The tree on the device, and what a shader that includes lighting/ray_tree.glsl needs.
struct DeviceRayTree {
  gpu::Image nodes, triangles;
  gpu::Bindings bindings() const { return {{"ray_nodes", nodes}, {"ray_triangles", triangles}}; }
};
DeviceRayTree upload_ray_tree(gpu::Context& context, const RayTree& tree);

}  // namespace alabaster

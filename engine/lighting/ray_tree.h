// What a ray meets in a scene, for passes that trace rays without ray-tracing hardware: a bounding volume hierarchy,
// built on the CPU, walked in compute by lighting/ray_tree.glsl (bindings "nodes" and "ray_triangles").
#pragma once

#include "gpu/pass.h"
#include "scene/scene.h"
#include "shared/ray_tree.h"

namespace alabaster {

struct RayTree {
  std::vector<RayNode> nodes;          // none where there are no triangles
  std::vector<RayTriangle> triangles;  // in the order of the leaves
};

/// By the surface area heuristic with binned centres (I. Wald, "On fast Construction of SAH-based Bounding Volume
/// Hierarchies", 2007). Translucent objects are closed: met from outside only.
RayTree make_ray_tree(const Scene& scene);

struct RayTreeHit {
  float distance = INFINITY;            // m
  std::uint32_t triangle = UINT32_MAX;  // of RayTree::triangles
};

/// The twin of the walk in lighting/ray_tree.glsl: the nearest triangle between `near` and `far`, m.
RayTreeHit trace(const RayTree& tree, glm::vec3 origin, glm::vec3 direction, float near = 0, float far = INFINITY);

/// The tree on the device.
struct DeviceRayTree {
  gpu::Buffer nodes, triangles;
  std::uint32_t count = 0;  // of nodes
  gpu::Bindings bindings() const { return {{"nodes", nodes}, {"ray_triangles", triangles}}; }
};
DeviceRayTree upload_ray_tree(gpu::Context& context, const RayTree& tree);

}  // namespace alabaster

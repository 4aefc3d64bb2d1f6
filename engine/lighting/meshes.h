// All triangles of a scene on the device, for shadow maps, pictures and rays.
#pragma once

#include <vector>

#include "gpu/raster.h"
#include "lighting/ray_tree.h"
#include "scene/scene.h"

namespace alabaster {

struct SceneMeshes {
  struct Range {
    std::uint32_t first = 0, count = 0;  // triangles
    Bounds bounds;                       // m
  };
  gpu::Buffer positions;      // vec3, m
  gpu::Buffer triangles;      // uvec3 into positions
  std::vector<Range> ranges;  // by object
  DeviceRayTree rays;         // the same triangles in an order of their own

  gpu::Geometry geometry(std::size_t object) const {
    return {&positions, &triangles, 3 * ranges[object].count, 3 * ranges[object].first};
  }
};

/// Objects keep their order; triangles and vertices inside one are sorted along a space-filling curve.
SceneMeshes upload_meshes(gpu::Context& context, const Scene& scene);
/// Without `rays`.
SceneMeshes upload_surfaces(gpu::Context& context, const Scene& scene);

}  // namespace alabaster

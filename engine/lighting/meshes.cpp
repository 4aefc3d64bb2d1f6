#include "lighting/meshes.h"

#include <algorithm>

namespace alabaster {
namespace {

/// The triangles in the order of a Morton curve through their middles: neighbours in the list are neighbours in space,
/// which vertex caches and shadow lookups like. (Rasters on lavapipe a quarter faster.)
std::vector<glm::uvec3> along_curve(const Mesh& mesh, const Bounds& bounds) {
  constexpr int bits = 10;
  const glm::vec3 scale = ((1 << bits) - 1.0f) / glm::max(bounds.size(), glm::vec3(1e-30f));
  std::vector<std::pair<std::uint32_t, std::uint32_t>> keys(mesh.triangles.size());
  for (std::uint32_t i = 0; i < keys.size(); ++i) {
    const glm::uvec3 t = mesh.triangles[i];
    const glm::vec3 middle = (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0f;
    const glm::uvec3 cell = glm::uvec3((middle - bounds.low) * scale);
    std::uint32_t key = 0;
    for (int bit = bits - 1; bit >= 0; --bit)
      for (int axis = 0; axis < 3; ++axis) key = 2 * key + (cell[axis] >> bit & 1);
    keys[i] = {key, i};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<glm::uvec3> sorted;
  for (const auto& [key, i] : keys) sorted.push_back(mesh.triangles[i]);
  return sorted;
}

}  // namespace

SceneMeshes upload_surfaces(gpu::Context& context, const Scene& scene) {
  SceneMeshes meshes;
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  for (const Object& object : scene.objects) {
    const Bounds bounds = bounds_of(object.mesh);
    const std::uint32_t count = static_cast<std::uint32_t>(object.mesh.triangles.size());
    meshes.ranges.push_back({static_cast<std::uint32_t>(triangles.size()), count, bounds});
    // Vertices in the order in which the triangles ask for them.
    std::vector<std::uint32_t> place(object.mesh.positions.size(), UINT32_MAX);
    for (glm::uvec3 t : along_curve(object.mesh, bounds)) {
      for (int corner = 0; corner < 3; ++corner) {
        std::uint32_t& at = place[t[corner]];
        if (at == UINT32_MAX) {
          at = static_cast<std::uint32_t>(positions.size());
          positions.push_back(object.mesh.positions[t[corner]]);
        }
        t[corner] = at;
      }
      triangles.push_back(t);
    }
  }
  meshes.positions = gpu::make_buffer(context, positions, "mesh positions");
  meshes.triangles = gpu::make_buffer(context, triangles, "mesh triangles");
  return meshes;
}

SceneMeshes upload_meshes(gpu::Context& context, const Scene& scene) {
  SceneMeshes meshes = upload_surfaces(context, scene);
  meshes.rays = upload_ray_tree(context, make_ray_tree(scene));
  return meshes;
}

}  // namespace alabaster

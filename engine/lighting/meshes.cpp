#include "lighting/meshes.h"

namespace alabaster {

SceneMeshes upload_meshes(gpu::Context& context, const Scene& scene) {
  SceneMeshes meshes;
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  for (const Object& object : scene.objects) {
    const std::uint32_t base = static_cast<std::uint32_t>(positions.size());
    meshes.ranges.push_back({static_cast<std::uint32_t>(triangles.size()),
                             static_cast<std::uint32_t>(object.mesh.triangles.size()), bounds_of(object.mesh)});
    positions.insert(positions.end(), object.mesh.positions.begin(), object.mesh.positions.end());
    for (const glm::uvec3& t : object.mesh.triangles) triangles.push_back(t + base);
  }
  meshes.positions = gpu::make_buffer(context, positions, "mesh positions");
  meshes.triangles = gpu::make_buffer(context, triangles, "mesh triangles");
  return meshes;
}

}  // namespace alabaster

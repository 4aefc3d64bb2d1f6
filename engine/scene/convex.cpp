#include "scene/convex.h"

#include <algorithm>

#include "scene/mesh_edges.h"

namespace alabaster {
namespace {

bool bends_inwards_only(const Mesh& mesh) {
  const double slack = 1e-6 * glm::length(bounds_of(mesh).size());
  bool convex = true;
  EdgeTable(mesh).for_each([&](std::span<const HalfEdge> edges) {
    for (const HalfEdge& e : edges) {
      const glm::uvec3 t = mesh.triangles[e.triangle];
      const glm::dvec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
      const glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
      for (const HalfEdge& other : edges)
        if (other.triangle != e.triangle)
          for (int corner = 0; corner < 3; ++corner)
            convex =
                convex &&
                !(glm::dot(normal, glm::dvec3(mesh.positions[mesh.triangles[other.triangle][corner]]) - a) > slack);
    }
  });
  return convex;
}

/// Triangles that hang together through vertices: 1 for one piece.
int pieces(const Mesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.positions.size());
  for (std::uint32_t i = 0; i < parent.size(); ++i) parent[i] = i;
  const auto root = [&](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const glm::uvec3& t : mesh.triangles) parent[root(t.y)] = root(t.x), parent[root(t.z)] = root(t.x);
  std::vector<std::uint32_t> roots;
  for (const glm::uvec3& t : mesh.triangles) roots.push_back(root(t.x));
  std::sort(roots.begin(), roots.end());
  return static_cast<int>(std::unique(roots.begin(), roots.end()) - roots.begin());
}

}  // namespace

bool is_convex(const Mesh& mesh) { return bends_inwards_only(mesh) && pieces(mesh) == 1; }

}  // namespace alabaster

#include "scene/mesh_holes.h"

#include <unordered_map>

#include "scene/mesh_edges.h"

namespace alabaster {
namespace {

Hole measured(const Mesh& mesh, std::vector<unsigned> vertices) {
  Hole hole{std::move(vertices)};
  for (unsigned v : hole.vertices) hole.centre += mesh.positions[v] / float(hole.vertices.size());
  for (std::size_t i = 0; i < hole.vertices.size(); ++i) {
    glm::dvec3 a = mesh.positions[hole.vertices[i]] - hole.centre;
    glm::dvec3 b = mesh.positions[hole.vertices[(i + 1) % hole.vertices.size()]] - hole.centre;
    hole.patch_area += 0.5 * glm::length(glm::cross(a, b));
  }
  return hole;
}

}  // namespace

std::vector<Hole> find_holes(const Mesh& mesh) {
  // A patch runs along an open edge against the triangle that is there.
  std::unordered_multimap<unsigned, unsigned> next;
  std::vector<unsigned> starts;
  EdgeTable(mesh).for_each([&](std::span<const HalfEdge> edge) {
    if (edge.size() != 1) return;
    glm::uvec3 t = mesh.triangles[edge[0].triangle];
    unsigned a = t[edge[0].side], b = t[(edge[0].side + 1) % 3];
    next.emplace(b, a);
    starts.push_back(b);
  });
  // As many open edges arrive at a vertex as leave it, so every walk closes. Where it meets itself a loop is complete.
  std::vector<Hole> holes;
  for (unsigned start : starts) {
    std::vector<unsigned> path{start};
    std::unordered_map<unsigned, std::size_t> place{{start, 0}};
    for (auto step = next.find(start); step != next.end(); step = next.find(path.back())) {
      unsigned to = step->second;
      next.erase(step);
      auto met = place.find(to);
      if (met == place.end()) {
        place[to] = path.size();
        path.push_back(to);
        continue;
      }
      std::size_t first = met->second;
      holes.push_back(measured(mesh, {path.begin() + first, path.end()}));
      for (std::size_t i = first + 1; i < path.size(); ++i) place.erase(path[i]);
      path.resize(first + 1);
    }
  }
  return holes;
}

void fill(Mesh& mesh, const Hole& hole) {
  const std::vector<unsigned>& loop = hole.vertices;
  if (loop.size() == 3) {
    mesh.triangles.push_back({loop[0], loop[1], loop[2]});
    return;
  }
  unsigned centre = unsigned(mesh.positions.size());
  mesh.positions.push_back(hole.centre);
  for (std::size_t i = 0; i < loop.size(); ++i)
    mesh.triangles.push_back({loop[i], loop[(i + 1) % loop.size()], centre});
}

}  // namespace alabaster

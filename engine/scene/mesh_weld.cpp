#include "scene/mesh_weld.h"

#include <algorithm>
#include <array>
#include <unordered_map>

#include "scene/mesh_edges.h"

namespace alabaster {
namespace {

struct CellHash {
  std::size_t operator()(glm::ivec3 c) const {
    std::uint64_t h = 0;
    for (int axis = 0; axis < 3; ++axis) h = (h ^ std::uint32_t(c[axis])) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
    return h;
  }
};

/// The bits of a position; -0 and 0 are one place.
glm::ivec3 bits(glm::vec3 p) { return glm::floatBitsToInt(p + 0.0f); }

/// For every vertex the first one at its place.
std::vector<unsigned> exact_leaders(const std::vector<glm::vec3>& positions) {
  std::unordered_map<glm::ivec3, unsigned, CellHash> seen(2 * positions.size());
  std::vector<unsigned> leaders(positions.size());
  for (unsigned i = 0; i < positions.size(); ++i) leaders[i] = seen.try_emplace(bits(positions[i]), i).first->second;
  return leaders;
}

/// For every vertex the first one within `tolerance`, looked up in a hash of cells twice that wide.
std::vector<unsigned> near_leaders(const std::vector<glm::vec3>& positions, float tolerance) {
  glm::vec3 low = positions.empty() ? glm::vec3(0) : positions[0];
  for (glm::vec3 p : positions) low = glm::min(low, p);
  std::unordered_multimap<glm::ivec3, unsigned, CellHash> leaders_in;
  std::vector<unsigned> leaders(positions.size());
  for (unsigned i = 0; i < positions.size(); ++i) {
    glm::vec3 cell = (positions[i] - low) / (2 * tolerance);
    leaders[i] = i;
    for (int corner = 0; corner < 8 && leaders[i] == i; ++corner) {
      glm::vec3 step(corner & 1, corner >> 1 & 1, corner >> 2);
      auto [first, last] = leaders_in.equal_range(glm::ivec3(glm::floor(cell - 0.5f + step)));
      for (auto other = first; other != last; ++other)
        if (glm::distance(positions[other->second], positions[i]) <= tolerance) leaders[i] = other->second;
    }
    if (leaders[i] == i) leaders_in.emplace(glm::ivec3(glm::floor(cell)), i);
  }
  return leaders;
}

/// height / length below which a triangle is a needle
constexpr double needle = 1e-6;

/// The longest side of a needle, or -1 for any other triangle.
int needle_side(const Mesh& mesh, glm::uvec3 t) {
  glm::dvec3 p[3];
  for (int i = 0; i < 3; ++i) p[i] = mesh.positions[t[i]];
  double length2[3];
  for (int i = 0; i < 3; ++i) length2[i] = glm::dot(p[(i + 1) % 3] - p[i], p[(i + 1) % 3] - p[i]);
  int longest = int(std::max_element(length2, length2 + 3) - length2);
  double twice_area = glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
  return twice_area <= needle * length2[longest] ? longest : -1;
}

}  // namespace

Mesh welded(const Mesh& mesh, float tolerance) {
  std::vector<unsigned> leaders =
      tolerance > 0 ? near_leaders(mesh.positions, tolerance) : exact_leaders(mesh.positions);
  std::vector<bool> used(mesh.positions.size());
  for (glm::uvec3 t : mesh.triangles)
    for (int i = 0; i < 3; ++i) used[leaders[t[i]]] = true;
  Mesh result;
  std::vector<unsigned> number(mesh.positions.size());
  for (unsigned i = 0; i < mesh.positions.size(); ++i) {
    if (!used[i]) continue;
    number[i] = unsigned(result.positions.size());
    result.positions.push_back(mesh.positions[i]);
  }
  for (glm::uvec3 t : mesh.triangles)
    result.triangles.push_back({number[leaders[t.x]], number[leaders[t.y]], number[leaders[t.z]]});
  return result;
}

std::size_t drop_degenerate(Mesh& mesh) {
  return std::erase_if(mesh.triangles, [](glm::uvec3 t) { return t.x == t.y || t.y == t.z || t.z == t.x; });
}

std::size_t drop_duplicates(Mesh& mesh) {
  std::unordered_map<glm::ivec3, bool, CellHash> seen(2 * mesh.triangles.size());
  return std::erase_if(mesh.triangles, [&](glm::uvec3 t) {
    std::array<unsigned, 3> sorted{t.x, t.y, t.z};
    std::sort(sorted.begin(), sorted.end());
    return !seen.try_emplace(glm::ivec3(sorted[0], sorted[1], sorted[2]), true).second;
  });
}

std::size_t flip_needles(Mesh& mesh) {
  std::size_t before = 0, left = 0;
  for (int pass = 0; pass < 8; ++pass) {
    std::vector<bool> is_needle(mesh.triangles.size());
    left = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      left += is_needle[t] = needle_side(mesh, mesh.triangles[t]) >= 0;
    if (pass == 0) before = left;
    if (left == 0) break;
    EdgeTable edges(mesh);
    std::vector<bool> touched(mesh.triangles.size());
    edges.for_each([&](std::span<const HalfEdge> edge) {
      if (edge.size() != 2) return;
      for (int i = 0; i < 2; ++i) {
        HalfEdge half = edge[i], other = edge[1 - i];
        if (!is_needle[half.triangle] || touched[half.triangle] || touched[other.triangle]) continue;
        glm::uvec3 &t = mesh.triangles[half.triangle], &n = mesh.triangles[other.triangle];
        if (needle_side(mesh, t) != half.side) continue;
        // (u, v, w) and its neighbour (v, u, d) become (u, d, w) and (d, v, w).
        unsigned u = t[half.side], v = t[(half.side + 1) % 3], w = t[(half.side + 2) % 3], d = n[(other.side + 2) % 3];
        if (d == w || edges.contains(d, w)) continue;
        t = {u, d, w};
        n = {d, v, w};
        touched[half.triangle] = touched[other.triangle] = true;
        return;
      }
    });
  }
  return before - std::min(before, left);
}

}  // namespace alabaster

#include "reference/distance_grid.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace alabaster {
namespace {

constexpr int cells_along = 96;    // an object's longest side
constexpr float far_away = 1e12f;  // cells^2: nothing seen yet
constexpr float rounding = 1e-3f;  // cells: slack of the voxelisation and of every stored distance

// Lower envelope of the parabolas f[q] + (p - q)^2, in place.
void envelope(std::vector<float>& f, std::vector<int>& site, std::vector<float>& start, std::vector<float>& out) {
  const int n = static_cast<int>(f.size());
  const auto at = [](auto& v, int i) -> auto& { return v[static_cast<std::size_t>(i)]; };
  int last = 0;
  at(site, 0) = 0;
  at(start, 0) = -INFINITY;
  for (int q = 1; q < n; ++q) {
    float s = 0;
    for (;; --last) {
      const int v = at(site, last);
      s = (at(f, q) - at(f, v) + static_cast<float>(q * q - v * v)) / static_cast<float>(2 * (q - v));
      if (s > at(start, last)) break;
    }
    ++last;
    at(site, last) = q;
    at(start, last) = s;
  }
  for (int q = 0, k = 0; q < n; ++q) {
    while (k < last && at(start, k + 1) < static_cast<float>(q)) ++k;
    const float d = static_cast<float>(q - at(site, k));
    at(out, q) = d * d + at(f, at(site, k));
  }
  f.swap(out);
}

}  // namespace

DistanceGrid::DistanceGrid(const Bounds& box, const std::vector<const Mesh*>& surfaces) {
  const glm::vec3 extent = box.size();
  cell_ = std::max({extent.x, extent.y, extent.z}) / cells_along;
  per_cell_ = 1 / cell_;
  low_ = box.low - cell_;
  size_ = glm::ivec3(glm::ceil(extent * per_cell_)) + 2;
  distance_.assign(
      static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y) * static_cast<std::size_t>(size_.z),
      far_away);
  for (const Mesh* mesh : surfaces)
    for (glm::uvec3 t : mesh->triangles) occupy(mesh->positions[t.x], mesh->positions[t.y], mesh->positions[t.z]);
  for (int axis = 0; axis < 3; ++axis) transform(axis);
  // The surface may be anywhere in the occupied cell.
  for (float& d : distance_) d = (std::sqrt(d) - 0.5f * std::sqrt(3.0f) - rounding) * cell_ - rounding * cell_;
}

// Marks every cell that the triangle's bounds touch, after cutting it until these are small.
void DistanceGrid::occupy(glm::vec3 a, glm::vec3 b, glm::vec3 c) {
  const glm::vec3 least = (glm::min(a, glm::min(b, c)) - low_) * per_cell_ - rounding;
  const glm::vec3 most = (glm::max(a, glm::max(b, c)) - low_) * per_cell_ + rounding;
  for (int axis = 0; axis < 3; ++axis)
    if (most[axis] < 0 || least[axis] >= static_cast<float>(size_[axis])) return;
  const glm::vec3 span = most - least;
  if (std::min({std::max(span.x, span.y), std::max(span.y, span.z), std::max(span.x, span.z)}) > 1.5f) {
    const glm::vec3 ab = 0.5f * (a + b), bc = 0.5f * (b + c), ca = 0.5f * (c + a);
    occupy(a, ab, ca);
    occupy(ab, b, bc);
    occupy(ca, bc, c);
    occupy(ab, bc, ca);
    return;
  }
  const glm::ivec3 first = glm::max(glm::ivec3(glm::floor(least)), glm::ivec3(0));
  const glm::ivec3 last = glm::min(glm::ivec3(glm::floor(most)), size_ - 1);
  for (int z = first.z; z <= last.z; ++z)
    for (int y = first.y; y <= last.y; ++y)
      for (int x = first.x; x <= last.x; ++x) distance_[index({x, y, z})] = 0;
}

void DistanceGrid::transform(int axis) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  tbb::parallel_for(0, size_[v], [&](int j) {
    const auto n = static_cast<std::size_t>(size_[axis]);
    std::vector<float> line(n), start(n), out(n);
    std::vector<int> site(n);
    glm::ivec3 cell;
    cell[v] = j;
    for (cell[u] = 0; cell[u] < size_[u]; ++cell[u]) {
      for (cell[axis] = 0; cell[axis] < size_[axis]; ++cell[axis])
        line[static_cast<std::size_t>(cell[axis])] = distance_[index(cell)];
      envelope(line, site, start, out);
      for (cell[axis] = 0; cell[axis] < size_[axis]; ++cell[axis])
        distance_[index(cell)] = line[static_cast<std::size_t>(cell[axis])];
    }
  });
}

}  // namespace alabaster

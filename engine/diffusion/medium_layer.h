// Where a cell is sampled, and what the samples of a layer of cells are: between the medium and its averages.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace alabaster {

inline constexpr double least_distance = 0.05;  // of an unknown from a face or the surface, in h: as in cut.glsl

/// m^3 points of the unit cube, one in each of m^3 boxes; seen along any axis, no two at the same place. So a layer
/// across an axis gets its share to 1 / m^3, and none hides between the points unless it is thinner than 1 / m.
class Pattern {
 public:
  explicit Pattern(int m);
  int m() const { return m_; }
  int count() const { return static_cast<int>(points_.size()); }
  glm::dvec3 operator[](int sample) const { return points_[sample]; }
  /// Number of sample `s` along `axis` in column (u, v).
  int in_column(int axis, int s, int u, int v) const {
    glm::ivec3 at;
    at[axis] = s, at[(axis + 1) % 3] = u, at[(axis + 2) % 3] = v;
    return at.x + m_ * (at.y + m_ * at.z);
  }
  /// All samples in order along `axis`; those that follow one another lie apart across it.
  const std::vector<int>& sorted(int axis) const { return sorted_[axis]; }
  double along(int i, int j, int k) const {
    return (i + (7 * (m_ * j + k) % (m_ * m_) + 0.5) / (m_ * m_)) / m_;  // 7 is prime to 4, 9 and 16
  }

 private:
  int m_;
  std::vector<glm::dvec3> points_;
  std::vector<int> sorted_[3];
};

/// How the samples of a cell vary: their variance, and half the mean square of the steps between samples in order along
/// each axis. Far below the variance for sheets across the axis, about the variance for sheets along it.
struct Texture {
  glm::dvec3 variance{0}, steps[3] = {glm::dvec3(0), glm::dvec3(0), glm::dvec3(0)};
};

/// Of the resistivities of one cell, 1/m, Pattern::count() of them, those whose bit is set in `solid` counting.
Texture texture_of(const Pattern& pattern, const glm::vec3* resistivities, std::uint64_t solid);

/// 1/kappa in each of the samples of a layer of cells, and which of them lie in the solid.
struct Layer {
  std::vector<glm::vec3> resistivity;  // 1/m, Pattern::count() a cell
  std::vector<std::uint64_t> solid;    // a bit a sample; 0 for cells outside
  std::vector<Texture> texture;
};
}  // namespace alabaster

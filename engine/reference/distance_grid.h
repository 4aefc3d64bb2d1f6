// How far the nearest surface is at the least: what lets a path deep inside an object go on without asking for
// surfaces.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "scene/scene.h"

namespace alabaster {

/// Cubic cells over a box, each with a lower bound of the distance from its centre to any triangle that reaches into
/// the box (surfaces outside the box are no nearer than its side, for points inside it). From conservatively voxelised
/// triangles by an exact Euclidean distance transform (P. Felzenszwalb, D. Huttenlocher, "Distance Transforms of
/// Sampled Functions", 2012), less half the occupied cell's diagonal.
class DistanceGrid {
 public:
  DistanceGrid() = default;
  DistanceGrid(const Bounds& box, const std::vector<const Mesh*>& surfaces);
  /// m; 0 or less where nothing is known.
  float clearance(glm::vec3 point) const {
    if (distance_.empty()) return 0;
    const glm::ivec3 cell = glm::clamp(glm::ivec3((point - low_) * per_cell_), glm::ivec3(0), size_ - 1);
    return distance_[index(cell)] - glm::length(point - low_ - (glm::vec3(cell) + 0.5f) * cell_);
  }

 private:
  std::size_t index(glm::ivec3 c) const {
    return (static_cast<std::size_t>(c.z) * static_cast<std::size_t>(size_.y) + static_cast<std::size_t>(c.y)) *
               static_cast<std::size_t>(size_.x) +
           static_cast<std::size_t>(c.x);
  }
  void occupy(glm::vec3 a, glm::vec3 b, glm::vec3 c);
  void transform(int axis);
  glm::vec3 low_{0};
  float cell_ = 0, per_cell_ = 0;
  glm::ivec3 size_{0};
  std::vector<float> distance_;  // m; in cells, squared, while it is made
};

}  // namespace alabaster

#include "scene/closest.h"

#include <algorithm>

namespace alabaster {
namespace {

/// On the segment from corner `i` to corner `j`.
Closest on_edge(glm::dvec3 p, const glm::dvec3* corners, int i, int j) {
  const glm::dvec3 edge = corners[j] - corners[i];
  const double square = glm::dot(edge, edge);
  const double along = square > 0 ? std::clamp(glm::dot(p - corners[i], edge) / square, 0.0, 1.0) : 0.0;
  Closest closest;
  closest.point = corners[i] + along * edge;
  closest.weights[i] = 1 - along;
  closest.weights[j] = along;
  return closest;
}

}  // namespace

Closest closest_on_triangle(glm::dvec3 p, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double square = glm::dot(normal, normal);
  if (square > 0) {
    const glm::dvec3 weights =
        glm::dvec3(glm::dot(glm::cross(c - b, p - b), normal), glm::dot(glm::cross(a - c, p - c), normal),
                   glm::dot(glm::cross(b - a, p - a), normal)) /
        square;
    if (weights.x >= 0 && weights.y >= 0 && weights.z >= 0)
      return {weights.x * a + weights.y * b + weights.z * c, weights};
  }
  const glm::dvec3 corners[3] = {a, b, c};
  Closest best = on_edge(p, corners, 0, 1);
  for (int i = 1; i < 3; ++i) {
    const Closest other = on_edge(p, corners, i, (i + 1) % 3);
    if (glm::distance(p, other.point) < glm::distance(p, best.point)) best = other;
  }
  return best;
}

}  // namespace alabaster

// The point of a triangle that is nearest to another point.
#pragma once

#include <glm/glm.hpp>

namespace alabaster {

struct Closest {
  glm::dvec3 point{0};
  // Barycentric coordinates of `point`; those of corners it does not depend on are exactly 0.
  glm::dvec3 weights{0};
};

/// Inside its prism the foot of the perpendicular, else the nearest point of its three edges.
Closest closest_on_triangle(glm::dvec3 p, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c);

}  // namespace alabaster

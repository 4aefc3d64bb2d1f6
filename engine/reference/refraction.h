// Seeing a light through a smooth surface that bends the way to it.
#pragma once

#include "reference/world.h"

namespace alabaster {

/// Where a straight way from `x`, refracted once at the plane through `p` with unit normal `n` (x on its negative side,
/// y on its positive side), reaches `y`; `ratio` = index at x / index at y. By Snell's law the way's horizontal share
/// is the root of a monotone function.
struct PlanarRefraction {
  glm::dvec3 point{0};  // on the plane, m
  /// Solid angle at x per area at y that is perpendicular to the arriving ray, 1/m^2.
  double spread = 0;
  double cosine_near = 0, cosine_far = 0;  // with the normal, on x's and on y's side
};
PlanarRefraction refract_between(glm::dvec3 x, glm::dvec3 y, glm::dvec3 p, glm::dvec3 n, double ratio);

struct RefractedWay {
  Leaving where;           // the triangle, of the innermost object that `x` is in
  glm::vec3 direction{0};  // from x, unit
  float distance = 0;      // from x to the surface, m
  PlanarRefraction bend;
};

/// The ways from x to y through the surface of the object that holds x, each bent by the plane of the triangle that it
/// meets. A walk over the triangles leads to one (solve for the plane, look which triangle is met in that direction,
/// and again with its plane: J. Hanika, M. Droske, L. Fascione, "Manifold Next Event Estimation", 2015, for flat
/// triangles); where triangles meet at an angle there are often two, so those around it are tried as well. Not every
/// way is found, but which are is a function of x and y alone: a path that met the light by chance can ask whether it
/// would have been found.
class RefractedWays {
 public:
  RefractedWays(const World& world, glm::vec3 x, const Inside& inside, float ratio);
  /// Calls `use` with every way that is found to `y`.
  template <class Use>
  void each(glm::vec3 y, Use use) const {
    RefractedWay way;
    if (!walk(y, way)) return;
    const Leaving found = way.where;
    use(way);
    world_.around(found, [&](std::uint32_t triangle) {
      if (try_triangle(y, {found.object, triangle}, way)) use(way);
    });
  }
  /// The way through `exit`, which a path took; false where each() would not find it.
  bool through(glm::vec3 y, Leaving exit, RefractedWay& way) const;

 private:
  bool solve(glm::vec3 y, Leaving where, RefractedWay& way) const;
  bool walk(glm::vec3 y, RefractedWay& way) const;
  bool try_triangle(glm::vec3 y, Leaving where, RefractedWay& way) const;
  const World& world_;
  glm::vec3 x_;
  const Inside& inside_;
  float ratio_;
};

}  // namespace alabaster

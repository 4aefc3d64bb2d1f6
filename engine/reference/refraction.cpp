#include "reference/refraction.h"

#include <cmath>

namespace alabaster {
namespace {
constexpr int most_steps = 8;  // of the walk; most end after two
}

PlanarRefraction refract_between(glm::dvec3 x, glm::dvec3 y, glm::dvec3 p, glm::dvec3 n, double ratio) {
  const double near = glm::dot(p - x, n), far = glm::dot(y - p, n);  // distances from the plane
  const glm::dvec3 foot = x + near * n, across = y - far * n - foot;
  const double width = glm::length(across);
  // ratio sin(near) - sin(far) rises from below 0 to above 0 while the crossing point runs from x's foot to y's.
  double low = 0, high = width, a = width * near / (near + ratio * far);
  for (int step = 0; step < 60; ++step) {
    const double b = width - a, u = std::sqrt(a * a + near * near), v = std::sqrt(b * b + far * far);
    const double f = ratio * a / u - b / v, slope = ratio * near * near / (u * u * u) + far * far / (v * v * v);
    (f < 0 ? low : high) = a;
    const double newton = a - f / slope, next = newton > low && newton < high ? newton : 0.5 * (low + high);
    const bool settled = std::abs(next - a) <= 1e-8 * (near + width);
    a = next;
    if (settled) break;
  }
  PlanarRefraction r;
  r.point = foot + (width > 0 ? a / width : 0.0) * across;
  const double u = std::sqrt(a * a + near * near), b = width - a, v = std::sqrt(b * b + far * far);
  r.cosine_near = near / u;
  r.cosine_far = far / v;
  // d(width)/d(angle near), and sin(near)/width, which has a limit straight ahead.
  const double turn = ratio * r.cosine_near / r.cosine_far;  // d(angle far)/d(angle near)
  const double widening = near / (r.cosine_near * r.cosine_near) + far / (r.cosine_far * r.cosine_far) * turn;
  const double sine_over_width = a > 1e-9 * (near + far) ? a / u / width : 1 / (near + ratio * far);
  r.spread = sine_over_width / widening / r.cosine_far;
  return r;
}

RefractedWays::RefractedWays(const World& world, glm::vec3 x, const Inside& inside, float ratio)
    : world_(world), x_(x), inside_(inside), ratio_(ratio) {}

// For the triangle's plane, whether or not the point is in the triangle.
bool RefractedWays::solve(glm::vec3 y, Leaving where, RefractedWay& way) const {
  const glm::dvec3 p(world_.corners(where)[0]), n(world_.normal(where)), x(x_);
  const double least = static_cast<double>(world_.nudge());
  if (glm::dot(p - x, n) <= least || glm::dot(glm::dvec3(y) - p, n) <= least) return false;
  way.bend = refract_between(x, glm::dvec3(y), p, n, static_cast<double>(ratio_));
  const glm::dvec3 leg = way.bend.point - x;
  way.where = where;
  way.distance = static_cast<float>(glm::length(leg));
  way.direction = glm::vec3(glm::normalize(leg));
  return true;
}

bool RefractedWays::walk(glm::vec3 y, RefractedWay& way) const {
  glm::vec3 direction = glm::normalize(y - x_);
  Leaving solved;
  for (int step = 0; step < most_steps; ++step) {
    Hit hit;
    if (!world_.next_surface(x_, direction, INFINITY, inside_, {}, hit) || hit.where.object != inside_.top())
      return false;
    if (hit.where.triangle == solved.triangle) return true;
    if (!solve(y, hit.where, way)) return false;
    direction = way.direction;
    solved = hit.where;
  }
  return false;
}

bool RefractedWays::try_triangle(glm::vec3 y, Leaving where, RefractedWay& way) const {
  if (!solve(y, where, way)) return false;
  const auto corners = world_.corners(where);
  const glm::dvec3 n(world_.normal(where));
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 a(corners[k]), b(corners[(k + 1) % 3]);
    if (glm::dot(glm::cross(b - a, way.bend.point - a), n) < 0) return false;
  }
  Hit hit;
  return world_.next_surface(x_, way.direction, INFINITY, inside_, {}, hit) && hit.where.object == where.object &&
         hit.where.triangle == where.triangle;
}

bool RefractedWays::through(glm::vec3 y, Leaving exit, RefractedWay& way) const {
  if (!walk(y, way)) return false;
  if (way.where.triangle == exit.triangle) return true;
  bool found = false;
  world_.around(way.where, [&](std::uint32_t triangle) { found = found || triangle == exit.triangle; });
  return found && solve(y, exit, way);
}

}  // namespace alabaster

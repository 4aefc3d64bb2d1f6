#include "lighting/shadow_views.h"

#include <algorithm>
#include <cmath>

namespace alabaster {
namespace {

Focus around(const Scene& scene, const std::vector<std::size_t>& objects) {
  Focus focus;
  Bounds box;
  for (std::size_t i : objects)
    for (const glm::vec3& p : scene.objects[i].mesh.positions) box.add(p), focus.points.push_back(p);
  if (focus.points.empty()) return focus;
  focus.centre = box.centre();
  for (const glm::vec3& p : focus.points)
    focus.radius = std::max(focus.radius, glm::distance(glm::dvec3(p), focus.centre));
  return focus;
}

/// Right, down and forward of a viewer that looks along `forward`; right x down = forward.
struct Axes {
  glm::dvec3 right, down, forward;
};

Axes axes_along(glm::dvec3 forward) {
  const glm::dvec3 away = std::abs(forward.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 right = glm::normalize(glm::cross(away, forward));
  return {right, glm::cross(forward, right), forward};
}

/// A matrix by its rows (direction, offset).
glm::mat4 from_rows(glm::dvec4 x, glm::dvec4 y, glm::dvec4 z, glm::dvec4 w) {
  return glm::mat4(glm::transpose(glm::dmat4(x, y, z, w)));
}

/// Perspective without a far plane: z / w = 1 - near / w.
ShadowView perspective(glm::dvec3 eye, const Axes& axes, double tangent, double near) {
  const auto row = [&](glm::dvec3 axis, double scale) { return glm::dvec4(axis, -glm::dot(axis, eye)) * scale; };
  const glm::dvec4 forward = row(axes.forward, 1);
  return {from_rows(row(axes.right, 1 / tangent), row(axes.down, 1 / tangent), forward - glm::dvec4(0, 0, 0, near),
                    forward),
          static_cast<float>(tangent)};
}

/// Half the edge of the square that holds all points, seen from `eye` at distance 1.
double half_tangent(const Focus& focus, glm::dvec3 eye, const Axes& axes) {
  double most = 0;
  for (const glm::vec3& point : focus.points) {
    const glm::dvec3 p = glm::dvec3(point) - eye;
    const double x = std::abs(glm::dot(axes.right, p)), y = std::abs(glm::dot(axes.down, p));
    most = std::max(most, std::max(x, y) / glm::dot(axes.forward, p));
  }
  return most;
}

/// The same from infinity, m.
double half_edge(const Focus& focus, const Axes& axes) {
  double most = 0;
  for (const glm::vec3& point : focus.points) {
    const glm::dvec3 p = glm::dvec3(point) - focus.centre;
    most = std::max(most, std::max(std::abs(glm::dot(axes.right, p)), std::abs(glm::dot(axes.down, p))));
  }
  return most;
}

/// Room for the texels beside the outermost point that the 2x2 filter and the shift along the normal reach.
double with_margin(double half_width, int map_size) { return half_width * (1 + 8.0 / map_size); }

/// Of a spot's outer half angle; infinite from 90 degrees on.
double cone_tangent(SpotCone cone) {
  const double cosine = -double(cone.offset) / double(cone.scale);
  return cosine > 0 ? std::sqrt(std::max(0.0, 1 - cosine * cosine)) / cosine : INFINITY;
}

}  // namespace

Focus shadow_focus(const Scene& scene) {
  std::vector<std::size_t> chosen, others;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const Role role = scene.objects[i].role;
    if (role == Role::translucent) chosen.push_back(i);
    if (role == Role::opaque) others.push_back(i);
  }
  if (chosen.empty()) return around(scene, others);
  Focus focus = around(scene, chosen);
  const double most = 2 * focus.radius;
  for (std::size_t i : others) {
    std::vector<std::size_t> more = chosen;
    more.push_back(i);
    const Focus grown = around(scene, more);
    if (grown.radius > most) continue;
    chosen = more;
    focus = grown;
  }
  return focus;
}

std::vector<ShadowView> point_views(const LightSample& sample, const Focus& focus, double nearest, int map_size) {
  const glm::dvec3 eye = sample.position, normal = sample.normal;
  const glm::dvec3 way = focus.centre - eye;
  const double distance = glm::length(way);
  if (sample.kind == light_one_sided && glm::dot(way, normal) < -focus.radius) return {};
  const double near = std::max(0.5 * nearest, 1e-3 * std::max(distance, focus.radius));
  constexpr double widest = 0.8660254037844386;  // sine of 60 degrees
  constexpr double widest_tangent = 1.7320508075688772;
  const double cone = sample.kind == light_spot ? cone_tangent(sample.cone) : INFINITY;
  double tangent = INFINITY;
  const Axes axes = axes_along(way / std::max(distance, 1e-30));
  if (focus.radius < widest * distance)
    tangent = focus.points.empty() ? focus.radius / std::sqrt(distance * distance - focus.radius * focus.radius)
                                   : half_tangent(focus, eye, axes);
  if (cone < std::min(tangent, widest_tangent))
    return {perspective(eye, axes_along(normal), with_margin(cone, map_size), near * 0.5)};
  if (std::isfinite(tangent)) return {perspective(eye, axes, with_margin(tangent, map_size), near)};
  // A face of the cube reaches 1 / sqrt(3) of its far corner's distance, and so does its near plane.
  const Axes a = axes_along(normal);
  std::vector<glm::dvec3> faces = {a.forward, a.right, -a.right, a.down, -a.down};
  if (sample.kind == light_two_sided || sample.kind == light_point) faces.push_back(-a.forward);
  std::vector<ShadowView> views;
  for (const glm::dvec3& face : faces)
    views.push_back(perspective(eye, axes_along(face), with_margin(1, map_size), near * 0.57));
  return views;
}

ShadowView direction_view(glm::vec3 from, const Focus& focus, const Bounds& scene, int map_size) {
  const Axes axes = axes_along(-glm::normalize(glm::dvec3(from)));
  const double half = focus.points.empty() ? focus.radius : half_edge(focus, axes);
  const double half_width = with_margin(std::max(half, 1e-9), map_size);
  double low = -focus.radius, high = focus.radius;  // of depth along the light, from the focus
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p = {(corner & 1 ? scene.high : scene.low).x, (corner & 2 ? scene.high : scene.low).y,
                          (corner & 4 ? scene.high : scene.low).z};
    const double depth = glm::dot(axes.forward, p - focus.centre);
    low = std::min(low, depth);
    high = std::max(high, depth);
  }
  const double margin = 0.01 * (high - low);
  const auto row = [&](glm::dvec3 axis, double scale) {
    return glm::dvec4(axis, -glm::dot(axis, focus.centre)) * scale;
  };
  const double scale = 1 / (high - low + 2 * margin);
  glm::dvec4 z = row(axes.forward, scale);
  z.w += (margin - low) * scale;
  return {from_rows(row(axes.right, 1 / half_width), row(axes.down, 1 / half_width), z, {0, 0, 0, 1}),
          static_cast<float>(half_width)};
}

}  // namespace alabaster

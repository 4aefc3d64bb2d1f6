// The double-precision twin of lighting/gather.glsl: the same sum over the same samples, with exact visibility by brute
// force. For small meshes.
#pragma once

#include "lighting/lights.h"
#include "shared/lighting.h"

namespace alabaster {

/// Distance along `ray` (unit) to the triangle, or infinity (Moeller-Trumbore).
inline double hit_distance(glm::dvec3 from, glm::dvec3 ray, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
  const glm::dvec3 ab = b - a, ac = c - a, p = glm::cross(ray, ac), t = from - a, q = glm::cross(t, ab);
  const double det = glm::dot(ab, p);
  if (det == 0) return INFINITY;
  const double u = glm::dot(t, p) / det, v = glm::dot(ray, q) / det, s = glm::dot(ac, q) / det;
  return u >= 0 && v >= 0 && u + v <= 1 && s > 0 ? s : INFINITY;
}

struct Seen {
  double distance = INFINITY;
  int object = -1;
  glm::uvec3 triangle{0};
};

/// The nearest surface but those of object `skip`, beyond `near`.
inline Seen nearest_hit(const Scene& scene, glm::dvec3 from, glm::dvec3 ray, int skip = -1, double near = 0) {
  Seen seen;
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    for (const glm::uvec3& t : scene.objects[i].mesh.triangles) {
      if (static_cast<int>(i) == skip) break;
      const auto& p = scene.objects[i].mesh.positions;
      const double d = hit_distance(from, ray, p[t.x], p[t.y], p[t.z]);
      if (d > near && d < seen.distance) seen = {d, static_cast<int>(i), t};
    }
  return seen;
}

/// E_t at a receiver. `shift` (m) lifts the point off its surface before shadow rays start.
inline glm::dvec3 exact_flux(const Scene& scene, const LightSamples& lights, const Receiver& receiver, double eta,
                             bool shadows = true, double shift = 1e-6) {
  const glm::dvec3 n = glm::normalize(glm::dvec3(receiver.normal)), x = receiver.position;
  glm::dvec3 sum(0);
  for (const LightSample& light : lights.area) {
    const bool far = light.kind == light_directional;
    const glm::dvec3 way = far ? -glm::dvec3(light.normal) : glm::dvec3(light.position) - x;
    const glm::dvec3 w = glm::normalize(way);
    const double distance = far ? INFINITY : glm::length(way), square = far ? 1 : distance * distance;
    const double sent =
        light_share<double>(light.kind, -glm::dot(glm::dvec3(light.normal), w), light.cone.scale, light.cone.offset);
    const double cos_middle = glm::dot(n, w), spread = far ? light.cone.scale : 0;
    const double cos_receiver = cosine_above_horizon<double>(cos_middle, spread);
    if (sent <= 0 || cos_receiver <= 0) continue;
    if (shadows && cos_middle > 0 && nearest_hit(scene, x + shift * n, w, light.object).distance < distance - shift)
      continue;
    const double visible = cosine_of_visible_part<double>(cos_middle, spread);
    sum += glm::dvec3(light.intensity) * (cos_receiver / visible * point_transfer(visible, sent, square, eta));
  }
  double blocked = 0, all = 0;
  for (const glm::vec3& direction : lights.directions) {
    const double cos_receiver = glm::dot(n, glm::dvec3(direction));
    if (cos_receiver <= 0) continue;
    const double weight = cos_receiver * fresnel_transmittance(cos_receiver, eta);
    all += weight;
    if (shadows && std::isfinite(nearest_hit(scene, x + shift * n, direction).distance)) blocked += weight;
  }
  const double open = all > 0 ? 1 - blocked / all : 1;
  return sum + glm::dvec3(lights.environment) * (M_PI * (1 - diffuse_reflectance(eta)) * open);
}

}  // namespace alabaster

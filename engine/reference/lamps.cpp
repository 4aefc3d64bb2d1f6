#include "reference/lamps.h"

#include <algorithm>
#include <cmath>

#include "shared/lighting.h"

namespace alabaster {

Lamp::Lamp(const PunctualLight& punctual, const Bounds& scene)
    : light(punctual), centre(punctual.position), radius(static_cast<float>(punctual.radius)) {
  const double inner = std::cos(light.inner_cone), outer = std::cos(light.outer_cone);
  const double scale = 1 / std::max(1e-3, inner - outer);
  cone_scale = static_cast<float>(scale);
  cone_offset = static_cast<float>(-outer * scale);
  const double sine = far() ? std::sin(light.radius) : light.radius;
  if (sine > 0) radiance = glm::vec3(glm::dvec3(light.intensity) / (M_PI * sine * sine));
  if (!far()) return;
  const float distance = 100 * glm::length(scene.size());
  centre = scene.centre() - distance * light.direction;
  radius = distance * static_cast<float>(std::tan(light.radius));
}

glm::vec3 Lamp::intensity(glm::vec3 direction) const {
  if (light.kind != PunctualLight::Kind::spot) return light.intensity;
  return light.intensity * spot_share(glm::dot(direction, light.direction), cone_scale, cone_offset);
}

glm::vec3 Lamp::seen(glm::vec3 origin, glm::vec3 direction, float limit) const {
  if (radiance == glm::vec3(0)) return glm::vec3(0);
  if (far()) {
    // The chord and not the cosine, which has no digits left near 1.
    const glm::vec3 off = direction + light.direction;
    const float chord = 2 * std::sin(0.5f * static_cast<float>(light.radius));
    return limit == INFINITY && glm::dot(off, off) < chord * chord ? radiance : glm::vec3(0);
  }
  const glm::vec3 way = centre - origin;
  const float along = glm::dot(way, direction);
  const glm::vec3 off = way - along * direction;
  const float square = radius * radius - glm::dot(off, off);
  if (square <= 0) return glm::vec3(0);
  const float distance = along - std::sqrt(square);
  if (distance <= 0 || distance >= limit) return glm::vec3(0);
  if (light.kind != PunctualLight::Kind::spot) return radiance;
  return radiance * spot_share(-glm::dot(direction, light.direction), cone_scale, cone_offset);
}

Lamp::Arrival Lamp::sample(glm::vec3 from, Random& random) const {
  Arrival arrival;
  const glm::vec3 way = centre - from;
  const float square = glm::dot(way, way), sine2 = far() ? 0 : radius * radius / square;
  if (!far() && !(square > radius * radius)) return arrival;
  const float angle = static_cast<float>(light.radius), half = std::sin(0.5f * angle);
  const float rim = far() ? std::cos(angle) : std::sqrt(1 - sine2);  // its cosine,
  const float depth = far() ? 2 * half * half : sine2 / (1 + rim);   // and 1 - that, without cancellation
  const glm::vec3 axis = far() ? -light.direction : way / std::sqrt(square);
  const float down = random.uniform() * depth;  // 1 - cosine of the direction
  arrival.direction = radius > 0 ? around(axis, 1 - down, random.uniform()) : axis;
  if (far()) {
    arrival.distance = INFINITY;
    arrival.irradiance = light.intensity * (2 / (1 + rim));
    return arrival;
  }
  const float off = square * down * (2 - down);  // squared distance of the centre from the ray
  arrival.distance = std::sqrt(square) * (1 - down) - std::sqrt(std::max(0.0f, radius * radius - off));
  arrival.irradiance = intensity(-arrival.direction) * (2 / (square * (1 + rim)));
  return arrival;
}

}  // namespace alabaster

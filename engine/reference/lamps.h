// Punctual lights as paths see them: small spheres, and discs in the sky.
#pragma once

#include "reference/random.h"
#include "scene/scene.h"

namespace alabaster {

/// A lamp stands in nobody's way and is not seen by the camera, neither directly nor mirrored: it lights what scatters.
/// Every ray that meets it carries the same radiance, but for a spot's cone.
struct Lamp {
  PunctualLight light;
  float cone_scale = 0, cone_offset = 0;  // spot
  glm::vec3 radiance{0};                  // W/m^2/sr, on a spot's axis; 0 for an ideal light, which no ray meets
  // As guides want it: the disc it shows.
  glm::vec3 centre{0};  // m; of a directional light a point far out
  float radius = 0;     // m
  float share = 0;      // probability that World::sample_light() picks this one

  Lamp(const PunctualLight& light, const Bounds& scene);
  bool far() const { return light.kind == PunctualLight::Kind::directional; }
  /// In W/sr, or W/m^2 across its way, towards a place in `direction` (unit) from the lamp.
  glm::vec3 intensity(glm::vec3 direction) const;
  /// Radiance that a ray picks up within `limit` (m, INFINITY: nothing ends it); 0 where it misses.
  glm::vec3 seen(glm::vec3 origin, glm::vec3 direction, float limit) const;

  struct Arrival {
    glm::vec3 direction{0};   // unit, towards the lamp
    float distance = 0;       // m, to its surface; INFINITY for a directional light
    glm::vec3 irradiance{0};  // W/m^2 across `direction`: radiance over the density of the direction
  };
  /// A direction even in the solid angle that the lamp fills; irradiance 0 from inside its sphere.
  Arrival sample(glm::vec3 from, Random& random) const;
};

}  // namespace alabaster

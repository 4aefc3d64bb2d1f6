// Emissive meshes, punctual lights and the environment as a list of samples. Deterministic: the same scene gives the
// same samples.
#pragma once

#include <vector>

#include "scene/scene.h"
#include "shared/lighting.h"

namespace alabaster {

struct LightSample {
  glm::vec3 position{0};   // m; unused where directional
  glm::vec3 normal{0};     // unit: front side of the mesh, or where a spot or directional light shines
  glm::vec3 intensity{0};  // W/sr along the normal (of a mesh: radiance times the area the sample stands for);
                           // directional: W/m^2 across its way
  std::uint32_t kind = light_one_sided;  // light_* (shared/lighting.h)
  SpotCone cone{0, 0};
  int object = -1;  // index in Scene::objects; -1 for a light without a mesh
};

struct LightSamples {
  std::vector<LightSample> area;      // and of punctual lights
  std::vector<glm::vec3> directions;  // unit, towards the environment; none where it is dark
  glm::vec3 environment{0};           // W/m^2/sr
};

/// A spot's fall between its cones; of other lights without meaning.
SpotCone spot_cone(const PunctualLight& light);

/// `samples` points over all emissive meshes and punctual lights, shared out in proportion to power with at least one
/// for each light that shines, stratified over each light's area; a punctual light takes few (its shadows have narrow
/// edges), an ideal one a single sample. `directions` evenly spread directions (a Fibonacci sphere) of the
/// constant environment, where it shines. Throws UserError for a negative or unbounded number.
LightSamples sample_lights(const Scene& scene, int samples, int directions = 0);

}  // namespace alabaster

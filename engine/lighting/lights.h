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
  SpotCone cone{0, 0};                   // of a directional light `scale` is its spread (shared/lighting.h)
  int object = -1;                       // index in Scene::objects; -1 for a light without a mesh
};

struct LightSamples {
  std::vector<LightSample> area;  // and of punctual lights, and parts of the environment's picture as directional ones
  std::vector<glm::vec3> directions;  // unit, towards a uniform environment; none where it is dark or a picture
  glm::vec3 environment{0};           // W/m^2/sr; 0 where it is a picture
};

/// A spot's fall between its cones; of other lights without meaning.
SpotCone spot_cone(const PunctualLight& light);

/// `samples` points over all emissive meshes and punctual lights, shared out in proportion to power with at least one
/// for each light that shines, stratified over each light's area; a punctual light takes few (its shadows have narrow
/// edges), an ideal one a single sample. `directions` evenly spread directions (a Fibonacci sphere) of the
/// constant environment, where it shines; at most as many samples of its picture, nearer where more light comes from.
/// Samples of one light that follow each other lie near each other.
/// Throws UserError for a negative or unbounded number.
LightSamples sample_lights(const Scene& scene, int samples, int directions = 0);

}  // namespace alabaster

// Emissive meshes and the environment as a list of samples. Deterministic: the same scene gives the same samples.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace alabaster {

struct LightSample {
  glm::vec3 position{0};   // m, on an emissive mesh
  glm::vec3 normal{0};     // unit, front side
  glm::vec3 intensity{0};  // W/sr along the normal: radiance times the area the sample stands for
  bool two_sided = false;
  int object = 0;  // index in Scene::objects
};

struct LightSamples {
  std::vector<LightSample> area;
  std::vector<glm::vec3> directions;  // unit, towards the environment; none where it is dark
  glm::vec3 environment{0};           // W/m^2/sr
};

/// `samples` points over all emissive meshes, shared out in proportion to power with at least one for each light that
/// shines, stratified over each light's area. `directions` evenly spread directions (a Fibonacci sphere) of the
/// constant environment, where it shines. Throws UserError for a negative or unbounded number.
LightSamples sample_lights(const Scene& scene, int samples, int directions = 0);

}  // namespace alabaster

#include "lighting/lights.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "scene/error.h"
#include "shared/lighting.h"

namespace alabaster {
namespace {

constexpr int most_samples = most_light_points;

struct Light {
  int object;
  std::vector<double> area_below;  // m^2; running sum over triangles
  double area() const { return area_below.back(); }
  double power = 0;  // W up to a common factor
  int samples = 1;
};

Light make_light(const Scene& scene, int index) {
  const Object& object = scene.objects[index];
  Light light{index, {}};
  double sum = 0;
  for (const glm::uvec3& t : object.mesh.triangles) {
    const glm::dvec3 a = object.mesh.positions[t.x], b = object.mesh.positions[t.y], c = object.mesh.positions[t.z];
    light.area_below.push_back(sum += 0.5 * glm::length(glm::cross(b - a, c - a)));
  }
  const glm::dvec3 radiance = object.radiance;
  if (sum > 0) light.power = sum * (radiance.r + radiance.g + radiance.b) * (object.two_sided ? 2 : 1);
  return light;
}

/// Shares `samples` out by power, at least one each, largest remainders first.
void share_out(std::vector<Light>& lights, int samples) {
  const int spare = std::max(0, samples - static_cast<int>(lights.size()));
  double power = 0;
  for (const Light& light : lights) power += light.power;
  std::vector<std::pair<double, std::size_t>> remainders;
  int given = 0;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const double share = spare * lights[i].power / power;
    lights[i].samples = 1 + static_cast<int>(share);
    given += static_cast<int>(share);
    remainders.push_back({std::floor(share) - share, i});
  }
  std::sort(remainders.begin(), remainders.end());
  for (int i = 0; i < spare - given; ++i) ++lights[remainders[i % remainders.size()].second].samples;
}

/// Golden-ratio sequence: with i / n it makes a Fibonacci lattice, the evenest there is in two dimensions.
double golden(int i) {
  const double x = 0.5 + 0.6180339887498949 * i;
  return x - std::floor(x);
}

/// Point i of n: stratified along the list of triangles by area, a Fibonacci lattice inside each.
LightSample sample_point(const Light& light, const Object& object, int i, int n) {
  const double along = (i + 0.5) / n * light.area();
  const auto found = std::upper_bound(light.area_below.begin(), light.area_below.end(), along);
  const std::size_t k = std::min<std::size_t>(found - light.area_below.begin(), light.area_below.size() - 1);
  const double low = k ? light.area_below[k - 1] : 0, width = light.area_below[k] - low;

  const glm::uvec3 t = object.mesh.triangles[k];
  const glm::dvec3 a = object.mesh.positions[t.x], b = object.mesh.positions[t.y], c = object.mesh.positions[t.z];
  const glm::dvec2 u = {(along - low) / width, golden(i)};
  const double root = std::sqrt(u.x);
  LightSample sample;
  sample.position = (1 - root) * a + root * (1 - u.y) * b + root * u.y * c;
  sample.normal = glm::normalize(glm::cross(b - a, c - a));
  sample.intensity = object.radiance * static_cast<float>(light.area() / n);
  sample.two_sided = object.two_sided;
  sample.object = light.object;
  return sample;
}

}  // namespace

LightSamples sample_lights(const Scene& scene, int samples, int directions) {
  if (samples < 1 || samples > most_samples || directions < 0 || directions > most_samples)
    throw UserError("light samples: " + std::to_string(samples) + " points and " + std::to_string(directions) +
                    " directions; choose 1 to " + std::to_string(most_samples) +
                    " points and at most as many directions");
  std::vector<Light> lights;
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    if (scene.objects[i].role == Role::emissive && !scene.objects[i].mesh.triangles.empty()) {
      Light light = make_light(scene, static_cast<int>(i));
      if (light.power > 0) lights.push_back(std::move(light));
    }

  LightSamples result;
  result.environment = scene.environment.radiance;
  if (!lights.empty()) share_out(lights, samples);
  for (const Light& light : lights)
    for (int i = 0; i < light.samples; ++i)
      result.area.push_back(sample_point(light, scene.objects[light.object], i, light.samples));
  if (result.area.size() > most_samples)
    throw UserError(scene.path + ": " + std::to_string(lights.size()) + " emissive meshes where " +
                    std::to_string(most_samples) + " are the most; join some of them");

  if (result.environment == glm::vec3(0)) return result;
  for (int i = 0; i < directions; ++i) {
    const double z = 1 - (2 * i + 1.0) / directions, turn = 2.399963229728653 * i;  // golden angle
    const double r = std::sqrt(1 - z * z);
    result.directions.push_back({r * std::cos(turn), r * std::sin(turn), z});
  }
  return result;
}

}  // namespace alabaster

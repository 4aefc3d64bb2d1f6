#include "scene/rough_lobe.h"

#include <algorithm>

namespace alabaster {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr int quadrature = 80;  // normals along each of the two directions of their square

double directional_albedo(double mu, double alpha, double eta) {
  mu = std::max(mu, 1e-4);
  const glm::vec3 o(std::sqrt(1 - mu * mu), 0, mu);
  double sum = 0;
  for (int a = 0; a < quadrature; ++a)
    for (int b = 0; b < quadrature; ++b) {
      const float u = (static_cast<float>(a) + 0.5f) / quadrature, v = (static_cast<float>(b) + 0.5f) / quadrature;
      const glm::dvec3 h = visible_normal(o, static_cast<float>(alpha), u, v);
      const double along = glm::dot(glm::dvec3(o), h), cos_i = 2 * along * h.z - mu;
      if (cos_i <= 0) continue;
      const double lambda = ggx_lambda(mu, alpha);
      sum += fresnel_reflectance(along, eta) * (1 + lambda) / (1 + lambda + ggx_lambda(cos_i, alpha));
    }
  return sum / (quadrature * quadrature);
}

}  // namespace

float RoughLobe::albedo_at(float mu) const {
  const float at = std::sqrt(std::clamp(mu, 0.0f, 1.0f)) * (rough_entries - 1);
  const int k = std::min(static_cast<int>(at), rough_entries - 2);
  return glm::mix(albedo[k], albedo[k + 1], at - static_cast<float>(k));
}

RoughView RoughLobe::view(float mu) const {
  return rough_view(albedo_at(mu), static_cast<float>(fresnel_reflectance(static_cast<double>(mu), eta)));
}

glm::vec2 RoughLobe::value_and_density(glm::vec3 o, glm::vec3 i) const {
  if (o.z <= 0 || i.z <= 0) return glm::vec2(0);
  const RoughView at_o = view(o.z), at_i = view(i.z);
  return rough_value_and_density(o, i, alpha, static_cast<float>(eta), at_o, at_i.deficit, mean_deficit);
}

glm::vec3 RoughLobe::mirrored(glm::vec3 o, glm::vec3 uvw) const { return rough_direction(o, alpha, view(o.z), uvw); }

RoughLobe make_rough_lobe(double roughness, double eta) {
  RoughLobe lobe;
  lobe.eta = eta;
  lobe.alpha = static_cast<float>(roughness * roughness);
  for (int k = 0; k < rough_entries; ++k) {
    const double t = static_cast<double>(k) / (rough_entries - 1);
    lobe.albedo[k] = static_cast<float>(directional_albedo(t * t, lobe.alpha, eta));
  }
  constexpr int steps = 2048;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double t = (i + 0.5) / steps;  // mu = t^2: 2 mu dmu = 4 t^3 dt
    sum += 4 * t * t * t / steps * static_cast<double>(lobe.view(static_cast<float>(t * t)).deficit);
  }
  lobe.mean_deficit = static_cast<float>(std::max(sum, 1e-9));
  return lobe;
}

}  // namespace alabaster

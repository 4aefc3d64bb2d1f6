// The rough surface's mirrored light: its albedo is Fresnel's, it is the same both ways, and it is sampled as it says.
#include "scene/rough_lobe.h"

#include <gtest/gtest.h>

#include <random>

namespace alabaster {
namespace {

constexpr double pi = 3.14159265358979323846;

glm::vec3 direction(double mu, double turn) {
  const double s = std::sqrt(1 - mu * mu);
  return {s * std::cos(turn), s * std::sin(turn), mu};
}

/// Density of `i` on a grid of normals h that is even in t, tan(theta_h) = alpha t / (1 - t), 1/sr.
double density_by_normals(const RoughLobe& lobe, glm::vec3 o, glm::vec3 i) {
  const glm::dvec3 h = glm::normalize(glm::dvec3(o) + glm::dvec3(i));
  const double tangent = std::sqrt(std::max(0.0, 1 - h.z * h.z)) / h.z, t = tangent / (lobe.alpha + tangent);
  const double slope = lobe.alpha / ((1 - t) * (1 - t));
  return 1 / (2 * pi * tangent * h.z * h.z * h.z * slope * 4 * glm::dot(glm::dvec3(o), h));
}

/// integral f(o, i) n.i di by the midpoint rule on two grids, of normals (fine where the lobe is narrow) and of
/// directions, each counted by its share of the density.
double albedo(const RoughLobe& lobe, glm::vec3 o) {
  constexpr int n = 300;
  double sum = 0;
  const auto add = [&](glm::vec3 i, bool of_normals) {
    const double by_normals = density_by_normals(lobe, o, i), both = by_normals + 1 / (2 * pi);
    if (of_normals || by_normals > 0) sum += lobe.value_and_density(o, i).x / both / (n * n);
  };
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b) {
      const double t = (a + 0.5) / n, tangent = lobe.alpha * t / (1 - t), turn = 2 * pi * (b + 0.5) / n;
      const glm::vec3 h = direction(1 / std::sqrt(1 + tangent * tangent), turn), i = 2 * glm::dot(o, h) * h - o;
      if (glm::dot(o, h) > 0 && i.z > 0) add(i, true);
      add(direction(t, turn), false);
    }
  return sum;
}

TEST(RoughLobe, MirrorsFresnelsShareInEveryDirection) {
  for (double eta : {1.3, 1.5, 0.8})
    for (double roughness : {0.1, 0.3, 0.6, 1.0}) {
      const RoughLobe lobe = make_rough_lobe(roughness, eta);
      for (double mu : {0.05, 0.2, 0.5, 0.8, 1.0}) {
        const double share = fresnel_reflectance(mu, eta);
        EXPECT_NEAR(albedo(lobe, direction(mu, 0.4)), share, 0.01 * share + 1e-4)
            << "eta " << eta << " roughness " << roughness << " mu " << mu;
      }
    }
}

TEST(RoughLobe, IsTheSameBothWays) {
  const RoughLobe lobe = make_rough_lobe(0.6, 1.5);
  for (double a : {0.1, 0.5, 0.9})
    for (double b : {0.2, 0.4, 0.8}) {
      const glm::vec3 o = direction(a, 0), i = direction(b, 2);
      EXPECT_NEAR(lobe.value_and_density(o, i).x / i.z, lobe.value_and_density(i, o).x / o.z,
                  1e-4 * lobe.value_and_density(i, o).x);
    }
}

TEST(RoughLobe, IndexAboveOneHardlyNeedsAScale) {
  for (double eta : {1.1, 1.3, 1.5, 2.0})
    for (double roughness : {0.1, 0.5, 1.0}) {
      const RoughLobe lobe = make_rough_lobe(roughness, eta);
      for (float mu = 0; mu <= 1; mu += 0.02f)
        EXPECT_GT(lobe.view(mu).scale, 0.94f) << eta << " " << roughness << " " << mu;
    }
}

TEST(RoughLobe, IsSampledWithItsDensity) {
  const RoughLobe lobe = make_rough_lobe(0.5, 1.5);
  constexpr int n = 400000;
  std::mt19937 engine(1);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (double mu : {0.15, 0.5, 0.95}) {
    const glm::vec3 o = direction(mu, 1);
    // Value over density adds up to F, and with i.z to the lobe's mean height.
    double sum = 0, height = 0, direct = 0;
    for (int k = 0; k < n; ++k) {
      const float u = uniform(engine), v = uniform(engine), w = uniform(engine);
      const glm::vec3 i = lobe.mirrored(o, {u, v, w});
      if (i.z <= 0) continue;
      const glm::vec2 f = lobe.value_and_density(o, i);
      sum += f.x / f.y, height += i.z * f.x / f.y;
    }
    for (int a = 0; a < 1000; ++a)
      for (int b = 0; b < 1000; ++b) {
        const glm::vec3 i = direction((a + 0.5) / 1000, 2 * pi * (b + 0.5) / 1000);
        direct += i.z * lobe.value_and_density(o, i).x * 2 * pi / 1e6;
      }
    const double share = fresnel_reflectance(mu, 1.5);
    EXPECT_NEAR(sum / n, share, 0.01 * share) << mu;
    EXPECT_NEAR(height / n, direct, 0.01 * direct) << mu;
  }
}

}  // namespace
}  // namespace alabaster

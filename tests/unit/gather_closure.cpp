// The closure of the gather (shading/gather_closure.h) against what its name promises, in slabs deep enough to be half
// spaces.
#include "shading/gather_closure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "shared/gather.h"

namespace alabaster {
namespace {

// Without absorption and at eta 1 the gather of Milne's fluence z + 2/3 sends 1/2 integral (mu + 2/3) mu dmu = 1/3, as
// the boundary condition does.
TEST(GatherClosure, MilneNeedsNoneAtEtaOne) { EXPECT_NEAR(gather_closure(1, 1).diffuse, 1, 1e-4); }

/// What leaves of a source in a half space with density `source` (of depth in mean free paths, isotropic), by brute
/// integration.
double leaves(double eta, const std::function<double(double)>& source) {
  const int cosines = 100, depths = 2000;
  double sum = 0;
  for (int o = 0; o < cosines; ++o) {
    const double out = (o + 0.5) / cosines, view = refracted_cosine(out, eta);
    double along = 0;
    for (int i = 0; i < depths; ++i) {
      const double z = 40.0 * (i + 0.5) / depths;
      along += source(z) * std::exp(-z / view) / view * 40.0 / depths;
    }
    sum += along * out * fresnel_transmittance(out, eta) / (2 * eta * eta * cosines);
  }
  return sum;
}

// Diffuse light on a half space, whose beams drive the fluence as shared/optics.h says they do.
TEST(GatherClosure, HalfSpaceInDiffuseLightSendsTheBoundaryConditionsFlux) {
  const int beams = 40;
  for (double eta : {1.0, 1.3, 1.5})
    for (double albedo : {0.8, 0.99}) {
      const double A = boundary_constant(internal_diffuse_reflectance<double>(eta)), q = std::sqrt(3 * (1 - albedo));
      const GatherClosure closure = gather_closure(albedo, eta);
      double sent = 0;
      std::vector<glm::dvec4> terms;  // k, B, C, share
      for (int i = 0; i < beams; ++i) {
        const double outside = (i + 0.5) / beams, k = 1 / refracted_cosine(outside, eta);
        const double share = outside * fresnel_transmittance(outside, eta), C = albedo * k / (1 - albedo - k * k / 3);
        terms.emplace_back(k, -C * (1 + 2 * A * k / 3) / (1 + 2 * A * q / 3), C, share);
        sent += share * directional_reflectance(1 / k, 1 - albedo, A);
      }
      const double gathered = leaves(eta, [&](double z) {
        double sum = 0;
        for (const glm::dvec4& t : terms)
          sum += t.w * (closure.diffuse * (t.y * std::exp(-q * z) + t.z * std::exp(-t.x * z)) +
                        closure.beams * t.x * std::exp(-t.x * z));
        return albedo * sum;
      });
      EXPECT_NEAR(gathered / sent, 1, 3e-3) << eta << " " << albedo;
    }
}

TEST(GatherClosure, TableHoldsIt) {
  const std::vector<glm::vec2> table = gather_closures(1.3);
  ASSERT_EQ(table.size(), std::size_t(GATHER_CLOSURES));
  EXPECT_NEAR(table.front().x, gather_closure(1, 1.3).diffuse, 1e-6);
  EXPECT_NEAR(table.back().y, gather_closure(1 - GATHER_MOST_ABSORBED, 1.3).beams, 1e-6);
  for (const glm::vec2& closure : table)
    EXPECT_TRUE(closure.x > 0.3f && closure.x <= 1.001f && closure.y > 1 && closure.y < 2.5f);
}

}  // namespace
}  // namespace alabaster

// The arithmetic of single scattering (shared/single.h, shading/single.h) against closed forms.
#include <gtest/gtest.h>

#include "shading/single.h"

namespace alabaster {
namespace {

// Index-matched and isotropic: integral_0^1 (1/2) mu' / (mu + mu') dmu' = (1 - mu ln(1 + 1/mu)) / 2.
TEST(SingleShare, EqualsItsClosedForm) {
  for (double mu : {0.05, 0.3, 0.7, 1.0})
    EXPECT_NEAR(single_scattering_share(mu, 1, 0), 0.5 * (1 - mu * std::log(1 + 1 / mu)), 2e-4) << mu;
}

// Of diffuse light in a slab without a boundary's reflection half of the first scatterings go up; a denser medium keeps
// most of them, and forward scattering sends few back.
TEST(SingleShare, FallsWithTheIndexAndWithForwardScattering) {
  double before = 1;
  for (double eta : {1.0, 1.2, 1.5, 2.0}) {
    const double share = single_scattering_share(0.8, eta, 0);
    EXPECT_LT(share, before);
    EXPECT_GT(share, 0);
    before = share;
  }
  before = 1;
  for (double g : {-0.5, 0.0, 0.5, 0.9}) {
    const double share = single_scattering_share(1, 1, g);
    EXPECT_LT(share, before);
    EXPECT_GT(share, 0);
    before = share;
  }
  // At normal incidence the azimuth does not matter: one integral, here by Simpson's rule.
  const double g = 0.6;
  double simpson = 0;
  constexpr int n = 2000;
  for (int i = 0; i <= n; ++i) {
    const double mu = double(i) / n, weight = i == 0 || i == n ? 1 : i % 2 ? 4 : 2;
    simpson += weight / (3.0 * n) * 2 * M_PI * henyey_greenstein(g, -mu) * mu / (1 + mu);
  }
  EXPECT_NEAR(single_scattering_share(1, 1, g), simpson, 1e-5);
}

TEST(SingleShare, ThePhaseFunctionIsNormalised) {
  for (double g : {-0.7, 0.0, 0.3, 0.9}) {
    double sum = 0, mean = 0;
    constexpr int n = 200000;
    for (int i = 0; i < n; ++i) {
      const double cosine = -1 + (2 * i + 1.0) / n, p = 4 * M_PI / n * henyey_greenstein(g, cosine);
      sum += p, mean += p * cosine;
    }
    EXPECT_NEAR(sum, 1, 1e-5);
    EXPECT_NEAR(mean, g, 1e-5);
  }
}

TEST(SingleShare, MeanOfAnExponential) {
  EXPECT_NEAR(mean_exponential(0.0, 2.0), (1 - std::exp(-2.0)) / 2, 1e-15);
  for (double x : {-1e-2, -1e-4, 0.0, 1e-6, 0.99e-2, 1.01e-2})
    EXPECT_NEAR(mean_exponential(1.0, 1 + x), x == 0 ? std::exp(-1.0) : std::exp(-1.0) * -std::expm1(-x) / x, 3e-8);
}

// What is taken out leaves a half space as bright as it was, and never more than there is.
TEST(SingleShare, AHalfSpaceKeepsItsBrightness) {
  for (double eta : {1.0, 1.5})
    for (double absorbed : {0.0, 0.01, 0.1, 0.3}) {
      const double A = boundary_constant(internal_diffuse_reflectance(eta)), kappa = 1.0 / 3, gamma = 0.9;
      const double R = boundary_source_reflectance(kappa, absorbed, A), s = 0.07;
      // By the boundary condition and the query: phi = q / (1 + s), q = 4 gamma / F_dt, flux = (F_dt / 4) bracket.
      const double f_dt = 2 / (A + 1), phi = dsbc_source(gamma, f_dt) / (1 + 2 * A * std::sqrt(kappa * absorbed));
      EXPECT_NEAR(R * gamma, f_dt / 4 * query_bracket(phi, gamma, A, f_dt), 1e-12);
      const double rest = gamma_beside_single(gamma, s, kappa, absorbed, A);
      EXPECT_NEAR(R * rest + s, R * gamma, 1e-12);
      EXPECT_EQ(gamma_beside_single(gamma, 1.01 * R * gamma, kappa, absorbed, A), 0);
    }
  EXPECT_EQ(gamma_beside_single(0.5, 0.1, 1.0 / 3, 0.95, 1.0), 0);  // no diffusion left
}

}  // namespace
}  // namespace alabaster

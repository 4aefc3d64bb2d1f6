// shared/optics.h in double precision against closed forms, published values and exact identities.
#include "shared/optics.h"

#include <gtest/gtest.h>

#include "shared/beam.h"

namespace alabaster {
namespace {

TEST(Optics, FresnelAtNormalIncidenceBrewsterAndTotalReflection) {
  EXPECT_NEAR(fresnel_reflectance(1.0, 1.5), 0.04, 1e-12);
  EXPECT_NEAR(fresnel_reflectance(1.0, 1 / 1.5), 0.04, 1e-12);
  EXPECT_EQ(fresnel_reflectance(0.0, 1.5), 1.0);
  EXPECT_EQ(fresnel_reflectance(0.7, 1.0), 0.0);
  EXPECT_EQ(fresnel_reflectance(0.3, 1 / 1.5), 1.0);     // critical cosine 0.745
  const double brewster = 1 / std::sqrt(1 + 1.5 * 1.5);  // p-polarised light passes whole there
  const double t = refracted_cosine(brewster, 1.5), s = (brewster - 1.5 * t) / (brewster + 1.5 * t);
  EXPECT_NEAR(fresnel_reflectance(brewster, 1.5), s * s / 2, 1e-12);
}

TEST(Optics, FresnelIsReciprocal) {
  for (double eta : {0.7, 1.2, 1.5, 3.0})
    for (double mu = 0.05; mu <= 1; mu += 0.05) {
      const double inside = refracted_cosine(mu, eta);
      if (inside <= 0) continue;
      EXPECT_NEAR(fresnel_reflectance(mu, eta), fresnel_reflectance(inside, 1 / eta), 1e-12);
    }
}

TEST(Optics, DiffuseReflectanceAgainstPublishedAndClosedForm) {
  EXPECT_NEAR(internal_diffuse_reflectance(1.3), 0.4445, 5e-5);
  EXPECT_NEAR(internal_diffuse_reflectance(1.5), 0.5963, 5e-5);
  EXPECT_NEAR(boundary_constant(internal_diffuse_reflectance(1.3)), 2.600, 5e-4);
  EXPECT_NEAR(boundary_constant(internal_diffuse_reflectance(1.5)), 3.955, 1e-3);
  EXPECT_EQ(internal_diffuse_reflectance(1.0), 0.0);
  // Walsh 1926 (in Duntley 1942): diffuse light meeting a denser medium.
  for (double n : {1.1, 1.3, 1.5, 2.0, 3.0}) {
    const double n2 = n * n, n4 = n2 * n2;
    const double walsh = 0.5 + (n - 1) * (3 * n + 1) / (6 * (n + 1) * (n + 1)) +
                         n2 * (n2 - 1) * (n2 - 1) / std::pow(n2 + 1, 3) * std::log((n - 1) / (n + 1)) -
                         2 * n * n2 * (n2 + 2 * n - 1) / ((n2 + 1) * (n4 - 1)) +
                         8 * n4 * (n4 + 1) / ((n2 + 1) * (n4 - 1) * (n4 - 1)) * std::log(n);
    EXPECT_NEAR(diffuse_reflectance(n), walsh, 2e-6) << n;
  }
}

TEST(Optics, DiffuseTransmittanceConservesEtendue) {
  for (double eta : {0.6, 0.9, 0.999, 1.001, 1.3, 1.5, 3.0}) {
    EXPECT_NEAR(1 - internal_diffuse_reflectance(eta), (1 - diffuse_reflectance(eta)) / (eta * eta), 1e-12) << eta;
    // The identity again by brute force on the other side of the surface, which the code does not integrate.
    double sum = 0;
    const int steps = 200000;
    for (int i = 0; i < steps; ++i) {
      const double mu = (i + 0.5) / steps;
      sum += 2 * mu * fresnel_reflectance(mu, 1 / eta) / steps;
    }
    EXPECT_NEAR(internal_diffuse_reflectance(eta), sum, 2e-5) << eta;
  }
}

TEST(Optics, ReducedIntensityAtItsLimits) {
  EXPECT_EQ(reduced_intensity(0.0, 0.0), 1.0);
  EXPECT_EQ(reduced_intensity(0.0, 5.0), 1.0);
  EXPECT_EQ(reduced_intensity(1.0, 0.0), 0.0);
  EXPECT_NEAR(reduced_intensity(1.0, 2.0), std::exp(-0.5), 1e-15);
}

// The report's model in uniform light L: phi = q everywhere, so the query must return F_t L: what enters leaves.
TEST(Optics, FurnaceOfTheQuery) {
  for (double eta : {0.8, 1.0, 1.3, 1.5, 2.5}) {
    const double L = 0.7, pi = 3.14159265358979323846;
    const double f_dt = 1 - internal_diffuse_reflectance(eta), A = boundary_constant(1 - f_dt);
    const double gamma = pi * L * (1 - diffuse_reflectance(eta)), phi = dsbc_source(gamma, f_dt);
    for (double mu : {0.1, 0.5, 1.0}) {
      const double f_t = fresnel_transmittance(mu, eta);
      EXPECT_NEAR(query_radiance(query_bracket(phi, gamma, A, f_dt), f_t, 1 / (eta * eta)), f_t * L, 1e-6 * L)
          << eta << " " << mu;
      EXPECT_NEAR(query_radiance(query_bracket(phi, gamma, A, f_dt), f_t, 1.0), f_t * L * eta * eta,
                  1e-5 * L);  // trap 1
    }
  }
}

TEST(Optics, SurfaceFluenceSolvesTheBoundaryCondition) {
  const double phi = 0.3, q = 1.7, A = 2.6, d_over_kappa = 0.9;
  const double surface = dsbc_surface_fluence(phi, q, A, d_over_kappa);
  EXPECT_NEAR((q - surface) / (2 * A), (surface - phi) / d_over_kappa, 1e-12);
  EXPECT_NEAR((q - surface) / (2 * A), dsbc_conductance(A, d_over_kappa) * (q - phi), 1e-12);
}

TEST(Optics, DirectionalSourceKeepsEnergyAndHasItsLimits) {
  for (double eta : {1.0, 1.3, 1.5}) {
    const double f_dt = 1 - internal_diffuse_reflectance(eta), A = boundary_constant(1 - f_dt);
    double diffuse = 0;
    for (int i = 0; i < 1000; ++i) {
      const double mu = (i + 0.5) / 1000;
      // Nothing absorbed: what does not enter the boundary condition leaves, at every angle.
      EXPECT_NEAR(directional_boundary(mu, 0.0, A, f_dt), 0.75 * f_dt * (mu + 2 * A / 3), 1e-14);
      EXPECT_NEAR(directional_boundary(mu, 0.0, A, f_dt) + directional_exit(mu, 0.0, A, f_dt), 1, 1e-14);
      EXPECT_NEAR(
          entering_flux(directional_boundary(mu, 0.0, A, f_dt),
                        directional_boundary(mu, 0.0, A, f_dt) - A * directional_exit(mu, 0.0, A, f_dt), A, f_dt),
          1, 1e-12);
      diffuse += 2 * mu * directional_boundary(mu, 0.0, A, f_dt) / 1000;
      for (double absorbed : {1e-3, 0.1, 0.3, 1 / 3.0, 0.7, 1.0}) {  // no pole, nowhere more than 1.2 times
        const double f = directional_boundary(mu, absorbed, A, f_dt), rho = directional_reflectance(mu, absorbed, A);
        EXPECT_GE(f, 0);
        EXPECT_LE(f, 1.2 * directional_boundary(mu, 0.0, A, f_dt) * (1 + 1e-12));
        EXPECT_GE(rho, 0);
        EXPECT_LE(rho, 1 - absorbed);
        // The half space's phi on the surface is q / (1 + s): the query then sends rho back.
        const double s = 2 * A * std::sqrt(3 * absorbed) / 3, c = directional_exit(mu, absorbed, A, f_dt);
        const double back = f_dt / 4 * query_bracket(dsbc_source(f, f_dt) / (1 + s), f - A * c, A, f_dt);
        EXPECT_NEAR(back, rho, 1e-12);
      }
    }
    if (eta == 1) {
      EXPECT_NEAR(diffuse, 1, 1e-5);  // the report's source, for diffuse light
    }
  }
}

// phi of a delta source at depth z, P1 with absorption, by shooting: below z as if 4 f / F_dt stood on the boundary.
TEST(Optics, BuriedSourceDrivesWhatLiesBelow) {
  const double A = 2.6, f_dt = 2 / (A + 1), kappa = 0.4, z = 0.7;
  for (double per_length : {0.0, 0.5, 1.5}) {
    const double sigma_a = kappa * per_length * per_length;
    const int steps = 4000;
    double phi = 2 * A * kappa, slope = 1;  // homogeneous: phi = 2 A kappa phi'
    const auto advance = [&](double& p, double& g) {
      const double h = z / steps, middle = g + 0.5 * h * sigma_a / kappa * p;
      const double before = p;
      p += h * middle;
      g += h * sigma_a / kappa * (before + 0.5 * h * g);
    };
    for (int i = 0; i < steps; ++i) advance(phi, slope);
    // Reciprocity: the response deep below to a unit source at z over that to a boundary value q is phi(z) / (kappa *
    // 1).
    const double q = phi / kappa;
    EXPECT_NEAR(4 * buried_boundary(z, per_length, kappa, A, f_dt) / f_dt / q, 1, 1e-3) << per_length;
  }
}

}  // namespace
}  // namespace alabaster

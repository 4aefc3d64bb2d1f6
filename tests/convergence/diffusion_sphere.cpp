// The whole solver on bodies whose fluence is known.
#include "support/diffusion_device.h"

namespace alabaster {
namespace {

class DiffusionConvergence : public GpuTest {};

struct Sphere {
  double R = 0.5, kappa = 0.02, sigma_a = 0.5, eta = 1.3;

  /// phi(R) for the boundary value q: phi = C sinh(r/l)/r.
  double surface(double q) const {
    if (sigma_a == 0) return q;
    const double l = std::sqrt(kappa / sigma_a), s = std::sinh(R / l) / R,
                 A = boundary_constant(internal_diffuse_reflectance(eta));
    return q * s / (s + 2 * A * kappa * (std::cosh(R / l) / (l * R) - std::sinh(R / l) / (R * R)));
  }
};

SurfaceError sphere_error(gpu::Context& context, const Sphere& sphere, int n, int corrections,
                          Solved* solved = nullptr) {
  const Mesh mesh = icosphere(6, static_cast<float>(sphere.R));
  SolverOptions options;
  options.corrections = corrections;
  Body body(context, mesh, n, uniform_medium(sphere.kappa, sphere.sigma_a), 1, sphere.eta, options);
  const Solved s = body.solve(glm::vec3(1));
  EXPECT_TRUE(s.status.converged) << s.status.reason;
  EXPECT_LT(s.energy.imbalance(), 1e-4);
  if (solved) *solved = s;
  const double expected = sphere.surface(dsbc_source(1.0, body.f_dt()));
  return surface_error(body, mesh, [&](glm::dvec3) { return expected; });
}

// Required: 0.5% at 64^3 and first order. The corrected scheme is second order; 128^3 takes too long here (0.0095%).
TEST_F(DiffusionConvergence, SphereIsSecondOrderAtTheSurface) {
  double last = 0;
  for (int n : {16, 32, 64, 128}) {
    const SurfaceError e = sphere_error(context, {}, n, 2);
    printf("sphere %3d: L2 %.4f%% bias %+.4f%% worst %.3f%%\n", n, 100 * e.l2, 100 * e.bias, 100 * e.worst);
    if (last > 0) {
      // At 128^3 the error is 1e-4, and something else than the cells' size begins to show.
      EXPECT_GT(std::log2(last / e.l2), n < 128 ? 1.7 : 1.0);
    }
    if (n == 64) {
      EXPECT_LT(e.l2, 0.0005);
    }
    last = e.l2;
  }
}

TEST_F(DiffusionConvergence, SphereIsFirstOrderWithoutCorrection) {
  double last = 0;
  for (int n : {16, 32, 64, 128}) {
    const SurfaceError e = sphere_error(context, {}, n, 0);
    printf("sphere, uncorrected %3d: L2 %.4f%%\n", n, 100 * e.l2);
    if (last > 0) {
      EXPECT_LT(e.l2, 0.7 * last);
    }
    last = e.l2;
  }
  EXPECT_LT(last, 0.0025);
}

TEST_F(DiffusionConvergence, AnOpaqueSphereGivesBackItsLight) {
  Sphere sphere;
  sphere.sigma_a = 0;
  for (double eta : {1.0, 1.3, 1.5}) {
    sphere.eta = eta;
    Solved s;
    const SurfaceError e = sphere_error(context, sphere, 32, 2, &s);
    EXPECT_LT(e.worst, 1e-4) << eta;
    EXPECT_NEAR(s.energy.out[0] / s.energy.in[0], 1, 1e-5) << eta;
  }
}

// phi = exp(a.x) solves the equation where kappa = k0 exp(b.x) and sigma_a = kappa a.(a + b); q follows on any surface.
// kappa varies 100-fold over the body. With a `feature`, m, the cells are sub-sampled.
void expect_manufactured(gpu::Context& context, double feature) {
  const double k0 = 0.004;
  const glm::dvec3 a(1.2, -0.8, 1.5), b = glm::normalize(glm::dvec3(2, 1, 1)) * std::log(100.0);
  const auto phi = [&](glm::dvec3 p) { return std::exp(glm::dot(a, p)); };
  const auto kappa = [&](glm::dvec3 p) { return k0 * std::exp(glm::dot(b, p)); };
  const auto medium = [&](glm::dvec3 p) {
    const double sigma_a = kappa(p) * glm::dot(a, a + b);
    return MediumPoint{glm::dvec3(1 / (3 * kappa(p)) - sigma_a), glm::dvec3(sigma_a)};
  };
  const MediumField field(medium, feature);
  const Mesh mesh = icosphere(6, 0.5f);
  const double A = boundary_constant(internal_diffuse_reflectance(1.3));
  double last = 0;
  for (int n : {16, 32, 64}) {
    Body body(context, mesh, n, field);
    std::vector<glm::vec3> gamma(body.cut_cells().size());
    for (std::size_t i = 1; i < gamma.size(); ++i) {
      const GpuFacet& facet = body.cut_cells()[i].facet;
      const glm::dvec3 p = body.facet_centre(i);
      const double slope = glm::dot(a, glm::dvec3(facet.area_vector) / double(facet.area));
      gamma[i] = glm::vec3(static_cast<float>(0.25 * body.f_dt() * phi(p) * (1 + 2 * A * kappa(p) * slope)));
    }
    const Solved s = body.solve(gamma);
    EXPECT_TRUE(s.status.converged) << s.status.reason;
    EXPECT_LT(s.energy.imbalance(), 1e-4);
    const SurfaceError e = surface_error(body, mesh, phi);
    printf("manufactured, feature %g, %3d: L2 %.4f%% worst %.3f%% iterations %d\n", feature, n, 100 * e.l2,
           100 * e.worst, s.status.iterations);
    if (last > 0) {
      EXPECT_GT(std::log2(last / e.l2), 1.5);
    }
    last = e.l2;
  }
  EXPECT_LT(last, 0.002);
}

TEST_F(DiffusionConvergence, ManufacturedSolutionWithHundredfoldKappa) { expect_manufactured(context, INFINITY); }
TEST_F(DiffusionConvergence, ManufacturedSolutionWithSubSampledMedium) { expect_manufactured(context, 0.02); }

// A slab cut out of an infinite one: the sides get the value that makes no flux.
TEST_F(DiffusionConvergence, SlabOfTwoExponentials) {
  const double kappa = 0.02, sigma_a = 0.5, l = std::sqrt(kappa / sigma_a),
               A = boundary_constant(internal_diffuse_reflectance(1.3));
  const auto phi = [&](glm::dvec3 p) { return std::exp(p.y / l) + 0.3 * std::exp(-p.y / l); };
  const auto slope = [&](glm::dvec3 p) { return (std::exp(p.y / l) - 0.3 * std::exp(-p.y / l)) / l; };
  const Mesh mesh = box({0.8f, 0.31f, 0.8f}, 16);
  double last = 0;
  for (int n : {16, 32, 64}) {
    Body body(context, mesh, n, uniform_medium(kappa, sigma_a));
    std::vector<glm::vec3> gamma(body.cut_cells().size());
    for (std::size_t i = 1; i < gamma.size(); ++i) {
      const GpuFacet& facet = body.cut_cells()[i].facet;
      const glm::dvec3 p = body.facet_centre(i);
      const double q = phi(p) + 2 * A * kappa * slope(p) * double(facet.area_vector.y / facet.area);
      gamma[i] = glm::vec3(static_cast<float>(0.25 * body.f_dt() * q));
    }
    const Solved s = body.solve(gamma);
    EXPECT_TRUE(s.status.converged) << s.status.reason;
    const SurfaceError e = surface_error(body, mesh, phi);
    printf("slab %3d: L2 %.4f%% worst %.3f%%\n", n, 100 * e.l2, 100 * e.worst);
    if (last > 0) {
      EXPECT_LT(e.l2, 0.6 * last);
    }
    last = e.l2;
  }
  EXPECT_LT(last, 0.005);
}

}  // namespace
}  // namespace alabaster

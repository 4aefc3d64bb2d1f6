// The whole solver on spheres whose fluence is known.
#include "diffusion/diffusion.h"
#include "shared/optics.h"
#include "scene/shapes.h"
#include "support/device.h"

namespace alabaster {
namespace {

struct Sphere {
  double R = 0.5, kappa = 0.02, sigma_a = 0.5, eta = 1.3;

  double A() const { return boundary_constant(internal_diffuse_reflectance(eta)); }
  /// phi(R) for the boundary value q: phi = C sinh(r/l)/r.
  double surface(double q) const {
    if (sigma_a == 0) return q;
    const double l = std::sqrt(kappa / sigma_a), s = std::sinh(R / l) / R;
    return q * s / (s + 2 * A() * kappa * (std::cosh(R / l) / (l * R) - std::sinh(R / l) / (R * R)));
  }
};

/// Trilinear, as the raster pass samples it.
double sample(const std::vector<float>& rgba, const GridFrame& frame, glm::dvec3 world, int channel) {
  const glm::dvec3 p = (world - glm::dvec3(frame.origin)) / double(frame.h) - 0.5;
  const glm::ivec3 low = glm::ivec3(glm::floor(p));
  const glm::dvec3 f = p - glm::dvec3(low);
  double sum = 0;
  for (int c = 0; c < 8; ++c) {
    const glm::ivec3 up{c & 1, c >> 1 & 1, c >> 2}, cell = low + up;
    double w = 1;
    for (int a = 0; a < 3; ++a) w *= up[a] ? f[a] : 1 - f[a];
    sum += w * rgba[4 * (cell.x + std::size_t(frame.cells.x) * (cell.y + std::size_t(frame.cells.y) * cell.z)) + channel];
  }
  return sum;
}

struct Outcome {
  SolverStatus status;
  double l2 = 0, bias = 0, worst = 0;  // relative, of the surface fluence
  double imbalance = 0;
};

class DiffusionSphere : public GpuTest {
 protected:
  DiffusionPasses solver_passes{context};
  FluencePasses passes{context};
  DomainMaker maker{context};

  Outcome run(const Sphere& sphere, int n, int channels = 1, float gamma = 1, const SolverOptions& options = {}) {
    const Mesh mesh = icosphere(6, static_cast<float>(sphere.R));
    const Domain domain = maker.make(mesh, choose_frame(bounds_of(mesh), n, 4));
    const double sigma_s = 1 / (3 * sphere.kappa) - sphere.sigma_a;
    const MediumField field = [&](glm::dvec3) { return MediumPoint{glm::dvec3(sigma_s), glm::dvec3(sphere.sigma_a)}; };
    Diffusion diffusion(context, solver_passes, passes, domain, sample_medium(context, domain, field, channels), sphere.eta, options);
    const gpu::Buffer gamma_s = gpu::make_buffer(context, std::vector<glm::vec3>(domain.summary.cut_cells + 1, glm::vec3(gamma)), "gamma_s");
    Outcome outcome;
    outcome.status = diffusion.solve(gamma_s);
    outcome.imbalance = diffusion.energy(gamma_s).imbalance();
    const double expected = sphere.surface(dsbc_source(double(gamma), 1 - internal_diffuse_reflectance(sphere.eta)));
    const std::vector<float> rgba = gpu::download<float>(context, diffusion.surface());
    const double points = static_cast<double>(mesh.positions.size());  // the vertices lie on the sphere
    for (const glm::vec3& p : mesh.positions) {
      const double e = sample(rgba, domain.frame, p, channels - 1) / expected - 1;
      outcome.l2 += e * e / points;
      outcome.bias += e / points;
      outcome.worst = std::max(outcome.worst, std::abs(e));
    }
    outcome.l2 = std::sqrt(outcome.l2);
    return outcome;
  }
};

TEST_F(DiffusionSphere, SurfaceFluenceConverges) {
  for (int corrections : {0, 2}) { double last = 0;
  for (int n : {16, 32, 64, 128}) {
    SolverOptions options; options.corrections = corrections;
    const Outcome o = run({}, n, 1, 1, options);
    printf("n %3d  l2 %.4f%%  bias %+.4f%%  worst %.3f%%  order %.2f  iterations %d  residual %.1e  imbalance %.1e\n", n, 100 * o.l2, 100 * o.bias,
           100 * o.worst, last > 0 ? std::log2(last / o.l2) : 0.0, o.status.iterations, o.status.relative_residual[0], o.imbalance);
    EXPECT_TRUE(o.status.converged) << o.status.reason;
    EXPECT_LT(o.imbalance, 1e-4);
    last = o.l2;
  }}
}

TEST_F(DiffusionSphere, FurnaceIsFlat) {
  Sphere sphere;
  sphere.sigma_a = 0;
  for (double eta : {1.0, 1.3, 1.5}) {
    sphere.eta = eta;
    const Outcome o = run(sphere, 32, 3);
    printf("eta %.1f worst %.2e iterations %d imbalance %.1e\n", eta, o.worst, o.status.iterations, o.imbalance);
    EXPECT_TRUE(o.status.converged) << o.status.reason;
    EXPECT_LT(o.worst, 1e-4);
    EXPECT_LT(o.imbalance, 1e-4);
  }
}

}  // namespace
}  // namespace alabaster

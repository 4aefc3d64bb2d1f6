// The fluence solver on the device: its operator and residual against the twin, and its behaviour at the edges.
#include "alabaster-bench/problems.h"
#include "support/diffusion_device.h"
#include "support/diffusion_problems.h"

namespace alabaster {
namespace {

class GpuDiffusion : public GpuTest {};

MediumField rgb_checker(double block) {
  return [=](glm::dvec3 p) {
    const glm::ivec3 b = glm::ivec3(glm::floor(p / block));
    const double k = (b.x + b.y + b.z) & 1 ? 100 : 1;
    return MediumPoint{k * glm::dvec3(20, 30, 40), glm::dvec3(0.1, 0.5, 2)};
  };
}

twin::MaterialField channel_of(const MediumField& field, int channel) {
  return [=](glm::dvec3 p) {
    const MediumPoint m = field(p);
    return twin::Material{1 / (3 * (m.sigma_s_reduced[channel] + m.sigma_a[channel])), m.sigma_a[channel]};
  };
}

TEST_F(GpuDiffusion, OperatorAndResidualEqualTwin) {
  const Mesh mesh = transformed(box({1, 0.3f, 0.6f}, 4), rotation({1, 2, 3}, 31));
  SolverOptions options;
  options.corrections = 0;
  const MediumField field = rgb_checker(0.21);
  Body body(context, mesh, 28, field, 3, 1.3, options);
  const CutCells cells = cut_cells(mesh, body.domain().frame);
  const Solved solved = body.solve({1, 2, 3});
  ASSERT_TRUE(solved.status.converged) << solved.status.reason;
  const FluenceField phi = body.fluence();
  const std::vector<float> stencil = gpu::download<float>(context, body.diffusion().multigrid().finest().stencil);
  for (int channel = 0; channel < 3; ++channel) {
    const twin::Problem problem = twin::assemble(cells, channel_of(field, channel), body.diffusion().A());
    const twin::Lattice& grid = problem.a.grid;
    for (int axis = 0; axis < 3; ++axis) {
      twin::Vector face = problem.a.a[twin::low_face[axis]];
      for (double& v : face) v = -v;
      EXPECT_LT(worst_difference(unpack(stencil, grid, axis, DIFFUSION_FINEST_ENTRIES, channel), face), 1e-4) << axis;
    }
    twin::Vector reaction = problem.absorption, x(grid.size(), 0.0), r;
    for (std::size_t i = 0; i < reaction.size(); ++i) reaction[i] += problem.facet_conductance[i];
    EXPECT_LT(worst_difference(unpack(stencil, grid, DIFFUSION_REACTION, DIFFUSION_FINEST_ENTRIES, channel), reaction),
              1e-4);
    for (int z = 0; z < grid.n.z; ++z)
      for (int y = 0; y < grid.n.y; ++y)
        for (int i = 0; i < grid.n.x; ++i) x[grid.at({i, y, z})] = phi.at({i, y, z}, channel);
    problem.a.apply(x, r);
    twin::Vector b = problem.facet_conductance;
    for (std::size_t i = 0; i < b.size(); ++i) {
      b[i] *= dsbc_source(channel + 1.0, body.f_dt());
      r[i] = b[i] - r[i];
    }
    // Its own geometry's rounding (1e-6 of a cell) comes on top of the solver's 1e-6.
    EXPECT_LT(std::sqrt(twin::dot(r, r) / twin::dot(b, b)), 1e-5);
  }
}

TEST_F(GpuDiffusion, ChannelsAgreeAndRunsRepeatBitForBit) {
  const MediumField grey = [](glm::dvec3 p) { return MediumPoint{glm::dvec3(p.x > 0 ? 20 : 200), glm::dvec3(0.3)}; };
  Body one(context, icosphere(4, 0.5f), 24, grey, 1), three(context, icosphere(4, 0.5f), 24, grey, 3),
      again(context, icosphere(4, 0.5f), 24, grey, 3);
  one.solve(glm::vec3(0.7f));
  three.solve(glm::vec3(0.7f));
  again.solve(glm::vec3(0.7f));
  const FluenceField a = one.fluence(), b = three.fluence(), c = again.fluence();
  ASSERT_EQ(b.phi.size(), 3 * a.phi.size());
  for (std::size_t i = 0; i < b.phi.size(); ++i)
    ASSERT_EQ(b.phi[i], a.phi[i % a.phi.size()]) << i << " of " << a.phi.size();
  EXPECT_EQ(b.phi, c.phi);
}

TEST_F(GpuDiffusion, NoLightGivesNoFluence) {
  Body body(context, icosphere(4, 0.5f), 20, uniform_medium(0.02, 0.5), 3);
  Solved solved = body.solve({1, 0, 0});  // one channel lit
  EXPECT_TRUE(solved.status.converged) << solved.status.reason;
  EXPECT_EQ(solved.status.relative_residual[1], 0);
  const FluenceField lit = body.fluence();
  const std::size_t cells = lit.phi.size() / 3;
  for (std::size_t i = cells; i < lit.phi.size(); ++i) ASSERT_EQ(lit.phi[i], 0);
  solved = body.solve(glm::vec3(0));  // and then none, from a solution that is not zero
  EXPECT_TRUE(solved.status.converged) << solved.status.reason;
  EXPECT_EQ(solved.status.iterations, 0);
  for (double v : body.fluence().phi) ASSERT_EQ(v, 0);
}

TEST_F(GpuDiffusion, ScaleOfSpaceAndLightDoesNotMatter) {
  std::vector<double> relative;
  for (double metres : {1e-3, 1.0, 1e3})
    for (float light : {1e-12f, 1.f, 1e12f}) {
      Body body(context, icosphere(4, static_cast<float>(0.5 * metres)), 20,
                uniform_medium(0.02 * metres, 0.5 / metres));
      const Solved solved = body.solve(glm::vec3(light));
      EXPECT_TRUE(solved.status.converged) << metres << " m, " << light << ": " << solved.status.reason;
      EXPECT_LT(solved.energy.imbalance(), 1e-4) << metres << " m, " << light;
      relative.push_back(body.surface_at({0.5 * metres, 0, 0}) / light);
    }
  for (double v : relative) EXPECT_NEAR(v / relative[0], 1, 1e-4);
}

TEST_F(GpuDiffusion, AWarmStartSavesWork) {
  Body body(context, icosphere(4, 0.5f), 32, uniform_medium(0.02, 0.5));
  std::vector<glm::vec3> gamma(body.cut_cells().size());
  const auto light = [&](double shift) {
    for (std::size_t i = 1; i < gamma.size(); ++i)
      gamma[i] = glm::vec3(static_cast<float>(std::max(0.0, body.facet_centre(i).x + shift)));
    return body.solve(gamma).status;
  };
  const SolverStatus cold = light(0), same = light(0), moved = light(0.01);
  EXPECT_TRUE(cold.converged && same.converged && moved.converged);
  EXPECT_LE(same.iterations, 3);
  EXPECT_LT(moved.iterations, cold.iterations);
}

TEST_F(GpuDiffusion, ThinShapesAndOneLitFacetConverge) {
  const glm::dmat4 tilt = rotation({1, 2, 3}, 23);
  const Mesh shapes[] = {box({1, 0.012f, 0.9f}), transformed(box({1, 0.012f, 0.8f}), tilt),
                         transformed(cylinder(0.01f, 1, 8), tilt),
                         joined(transformed(icosphere(3, 0.2f), translation({0.3, 0.2, 0})),
                                transformed(icosphere(3, 0.2f), translation({-0.2, -0.3, 0.1}))),
                         icosphere(4, 0.5f)};
  for (const Mesh& mesh : shapes) {
    Body body(context, mesh, 36, uniform_medium(0.02, 0.5));
    std::vector<glm::vec3> gamma(body.cut_cells().size());
    gamma[gamma.size() / 2] = glm::vec3(1);
    const Solved solved = body.solve(gamma);
    EXPECT_TRUE(solved.status.converged) << solved.status.reason;
    EXPECT_LE(solved.status.iterations, 18);
    EXPECT_LT(solved.energy.imbalance(), 1e-4);
    double most = 0, least = 0;
    for (double v : body.fluence().phi) most = std::max(most, v), least = std::min(least, v);
    EXPECT_GT(most, 0);
    EXPECT_GE(least, -1e-5 * most);
  }
}

TEST_F(GpuDiffusion, ExtremeMediaEndHonestly) {
  for (double kappa : {1e-6, 1e-3, 1.0, 100.0})
    for (double optical : {0.0, 1e-6, 1e6}) {  // sigma_a L^2 / kappa
      const MediumField field = [=](glm::dvec3) {
        const double sigma_a = std::min(optical * kappa, 0.3 / kappa);
        return MediumPoint{glm::dvec3(1 / (3 * kappa) - sigma_a), glm::dvec3(sigma_a)};
      };
      Body body(context, icosphere(3, 0.5f), 20, field, 1, 1.5);
      const Solved solved = body.solve(glm::vec3(1));
      EXPECT_TRUE(solved.status.converged || !solved.status.reason.empty());
      EXPECT_TRUE(solved.status.converged)
          << "kappa " << kappa << " absorption " << optical << ": " << solved.status.reason;
      EXPECT_LT(solved.energy.imbalance(), 1e-4) << "kappa " << kappa << " absorption " << optical;
      for (double v : body.fluence().phi) ASSERT_TRUE(std::isfinite(v) && v >= -1e-5);
    }
}

TEST_F(GpuDiffusion, GivesUpWithAReason) {
  SolverOptions options;
  options.max_iterations = 2;
  Body body(context, icosphere(4, 0.5f), 24, rgb_checker(0.2), 3, 1.3, options);
  const Solved solved = body.solve(glm::vec3(1));
  EXPECT_FALSE(solved.status.converged);
  EXPECT_NE(solved.status.reason.find("no convergence"), std::string::npos) << solved.status.reason;
  EXPECT_GT(solved.status.relative_residual[0], 1e-6);
}

TEST_F(GpuDiffusion, NoiseOfCellsIsNamedAndSharpPartsAreNot) {
  SolverOptions options;
  options.max_iterations = 2;
  const Mesh ball = icosphere(4, 0.5f);
  const double cell = choose_frame(bounds_of(ball), 24).h;
  const MediumField noise = [cell](glm::dvec3 p) {  // log-normal, contrast 1e8 between two deviations down and up
    const glm::uvec3 b(glm::ivec3(glm::floor(p / cell)) + 1000);
    std::mt19937 engine(b.x + 4001 * (b.y + 4001 * b.z));
    engine.discard(3);
    std::normal_distribution<double> normal;
    return scatterer(glm::dvec3(0.02 * std::exp(0.25 * std::log(1e8) * normal(engine))));
  };
  Body noisy(context, ball, 24, noise, 1, 1.3, options);
  const SolverStatus status = noisy.solve(glm::vec3(1)).status;
  EXPECT_FALSE(status.converged);
  EXPECT_NE(status.reason.find("noise at the scale of a cell"), std::string::npos) << status.reason;
  EXPECT_GT(noisy.diffusion().multigrid().deflation().noise(), 0.1);
  for (const MediumField& field : {vein_medium(0.1, 1e4), vein_medium(0.4, 1e6), checker_medium(0.11, 1e4)})
    EXPECT_LT(Body(context, ball, 24, field).diffusion().multigrid().deflation().noise(), 0.03);
}

}  // namespace
}  // namespace alabaster

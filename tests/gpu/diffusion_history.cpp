// Starting from the solutions of before: the passes against plain sums, and what they save when a light moves.
#include <numbers>

#include "diffusion/history.h"
#include "support/diffusion_device.h"

namespace alabaster {
namespace {

class GpuDiffusionHistory : public GpuTest {
 protected:
  static SolverOptions with_history(int corrections) {
    SolverOptions options;
    options.history = true;
    options.corrections = corrections;
    return options;
  }
  /// Sun light from a direction in the x-y plane.
  std::vector<glm::vec3> sun(double degrees) const {
    const glm::dvec3 to(std::sin(glm::radians(degrees)), std::cos(glm::radians(degrees)), 0.2);
    std::vector<glm::vec3> gamma;
    for (const GpuCutCell& cell : body.cut_cells()) {
      const glm::dvec3 n(cell.facet.area_vector);
      const double length = glm::length(n);
      gamma.emplace_back(length > 0 ? std::max(0.0, glm::dot(n, glm::normalize(to)) / length) : 0.0);
    }
    return gamma;
  }

  Body body{context, icosphere(4, 0.5f), 32, uniform_medium(0.02, 0.5), 1, 1.3, with_history(0)};
};

TEST_F(GpuDiffusionHistory, ProjectAndBlendEqualPlainSums) {
  Multigrid& multigrid = body.diffusion().multigrid();
  const DiffusionPasses passes(context);
  const glm::ivec3 n = multigrid.finest().cells;
  const std::vector<float> volume = gpu::download<float>(context, body.domain().volume);
  std::vector<std::vector<float>> values(6, std::vector<float>(volume.size()));
  std::vector<gpu::Image> images;
  for (std::size_t k = 0; k < values.size(); ++k) {  // four vectors, b, x
    for (std::size_t i = 0; i < volume.size(); ++i)
      if (volume[i] > 0) values[k][i] = static_cast<float>(std::sin(0.37 * double(i) * double(k + 1)));
    images.push_back(packed_image(context, n, 1, 1, "test"));
    gpu::upload(context, images.back(), values[k]);
  }
  const gpu::Image blended = packed_image(context, n, 1, 1, "test");
  const gpu::Buffer sums = gpu::make_buffer(context, std::vector<glm::vec4>(multigrid.bricks().count), "sums"),
                    coefficients = gpu::make_buffer(context, std::vector<glm::vec4>{{2, -3, 0.5f, 7}}, "coefficients");
  gpu::Commands commands(context);
  commands.dispatch(passes.project, multigrid.threads(0),
                    {{"bricks", multigrid.bricks().packed},
                     {"b", images[4]},
                     {"sums", sums},
                     {"v0", images[0]},
                     {"v1", images[1]},
                     {"v2", images[2]},
                     {"v3", images[3]}},
                    LevelPush{n, {}, 0, 0});
  commands.dispatch(passes.blend, multigrid.threads(0),
                    {{"bricks", multigrid.bricks().packed},
                     {"x", images[5]},
                     {"coefficients", coefficients},
                     {"v0", images[0]},
                     {"v1", images[1]},
                     {"v2", images[2]},
                     {"v3", images[3]},
                     {"blended", blended}},
                    LevelPush{n, {}, 0, 11});
  commands.submit();
  glm::dvec4 got(0), wanted(0);
  for (const glm::vec4& part : gpu::download<glm::vec4>(context, sums)) got += glm::dvec4(part);
  const std::vector<float> mixed = gpu::download<float>(context, blended);
  for (std::size_t i = 0; i < volume.size(); ++i) {
    for (int k = 0; k < 4; ++k) wanted[k] += double(values[k][i]) * values[4][i];
    const double value =
        2.0 * values[0][i] - 3.0 * values[1][i] + 0.5 * values[2][i] + 7.0 * values[3][i] + 11.0 * values[5][i];
    ASSERT_NEAR(mixed[i], value, 1e-5) << i;
  }
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(got[k], wanted[k], 1e-3) << k;
}

TEST_F(GpuDiffusionHistory, LightOfEarlierLightsIsSolvedAlready) {
  const std::vector<glm::vec3> lights[] = {sun(0), sun(50), sun(100)};
  int cold = 0;
  for (const auto& light : lights) cold = std::max(cold, body.solve(light).status.iterations);
  EXPECT_GE(cold, 5);
  std::vector<glm::vec3> sum = lights[0];
  for (std::size_t i = 0; i < sum.size(); ++i)
    sum[i] = 300.f * (0.2f * lights[0][i] + 0.5f * lights[1][i] + lights[2][i]);
  const Solved known = body.solve(sum);
  EXPECT_TRUE(known.status.converged);
  EXPECT_LE(known.status.iterations, 1);
  EXPECT_LE(known.status.relative_residual[0], 1e-6);
  EXPECT_LT(known.energy.imbalance(), 1e-4);
  // Another medium is another matrix: nothing is left to start from.
  body.diffusion().set_medium(sample_medium(context, body.domain(), uniform_medium(0.005, 5), 1));
  EXPECT_GE(body.solve(sum).status.iterations, 3);
}

TEST_F(GpuDiffusionHistory, SteadyMotionIsForeseen) {
  Body corrected(context, icosphere(4, 0.5f), 32, uniform_medium(0.02, 0.5), 1, 1.3, with_history(2));
  const int cold = corrected.solve(sun(0)).status.iterations;
  int last = cold;
  for (int step = 1; step <= 7; ++step) {  // more than are kept
    const Solved solved = corrected.solve(sun(3 * step));
    EXPECT_TRUE(solved.status.converged) << solved.status.reason;
    EXPECT_LT(solved.energy.imbalance(), 1e-4);
    last = solved.status.iterations;
  }
  EXPECT_LE(3 * last, 2 * cold);
}

// Of the fluence on the surface, to where deferred corrections lead in the end. Solves that start near their solution
// make one correction less than those that start from nothing.
TEST_F(GpuDiffusionHistory, MovedLightIsCorrectedAsFarAsLightOutOfNothing) {
  const auto made = [&](int corrections) {
    return std::make_unique<Body>(context, torus(0.35f, 0.15f, 48, 24), 32, uniform_medium(0.02, 0.5), 1, 1.3,
                                  with_history(corrections));
  };
  const std::unique_ptr<Body> moved = made(2), fresh = made(2), exact = made(9);
  const std::vector<GpuCutCell>& cut = moved->cut_cells();
  const auto lit = [&](double degrees) {
    const double turn = degrees * std::numbers::pi / 180;
    std::vector<glm::vec3> gamma;
    for (const GpuCutCell& cell : cut)
      gamma.emplace_back(std::max(
          0.f, cell.facet.area_vector.x * float(std::sin(turn)) + cell.facet.area_vector.y * float(std::cos(turn))));
    return gamma;
  };
  const auto apart = [&](Body& one) {
    const std::vector<float> got = gpu::download<float>(context, one.diffusion().surface()),
                             wanted = gpu::download<float>(context, exact->diffusion().surface());
    double difference = 0, square = 0;
    for (std::size_t i = 1; i < cut.size(); ++i) {
      const glm::ivec3 c = cut[i].cell, n = one.domain().frame.cells;
      const std::size_t at = 4 * (c.x + std::size_t(n.x) * (c.y + std::size_t(n.y) * c.z));
      difference += std::pow(got[at] - wanted[at], 2), square += std::pow(wanted[at], 2);
    }
    return std::sqrt(difference / square);
  };
  moved->solve(lit(0));
  for (const double degrees : {3.0, 13.0, 53.0}) {
    fresh->diffusion().forget();
    exact->diffusion().forget();
    for (Body* one : {moved.get(), fresh.get(), exact.get()})
      EXPECT_TRUE(one->solve(lit(degrees)).status.converged) << degrees;
    std::printf("at %g degrees: moved %.1e, fresh %.1e\n", degrees, apart(*moved), apart(*fresh));
    EXPECT_LT(apart(*moved), apart(*fresh)) << degrees;
  }
}

}  // namespace
}  // namespace alabaster

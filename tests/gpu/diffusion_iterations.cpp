// How many iterations the solver takes on the device, deferred corrections included, to a true residual of 1e-6.
#include <cstdio>

#include "support/diffusion_device.h"
#include "support/diffusion_problems.h"

namespace alabaster {
namespace {

class GpuDiffusionIterations : public GpuTest {
 protected:
  SolverStatus solve(int cells, const twin::MaterialField& material) {
    const MediumField field = [&](glm::dvec3 p) {
      const twin::Material m = material(p);
      return MediumPoint{glm::dvec3(1 / (3 * m.kappa) - m.sigma_a), glm::dvec3(m.sigma_a)};
    };
    return Body(context, icosphere(4, 0.5f), cells, field).solve(glm::vec3(1)).status;
  }
};

struct Row {
  std::string name;
  twin::MaterialField medium;
  int most;
};

std::vector<Row> rows() {
  std::vector<Row> list{{"contrast 1", checker(0.02, 1, 1), 8}};
  const struct {
    double contrast;
    int checker, other;
  } limits[] = {{1e2, 13, 11}, {1e4, 18, 12}, {1e6, 16, 12}};
  for (const auto& limit : limits) {
    char text[64];
    std::snprintf(text, sizeof text, "contrast %.0e, ", limit.contrast);
    list.push_back({text + std::string("checker"), checker(0.02, limit.contrast, 0.125), limit.checker});
    list.push_back({text + std::string("sharp layers"), sharp_layers(0.02, limit.contrast), limit.other});
    list.push_back({text + std::string("log-smooth"), log_smooth(0.02, limit.contrast), limit.other});
  }
  return list;
}

TEST_F(GpuDiffusionIterations, StayBoundedForAnyContrast) {
  for (const Row& row : rows()) {
    const SolverStatus status = solve(32, row.medium);
    EXPECT_TRUE(status.converged) << row.name << ": " << status.reason;
    EXPECT_LE(status.iterations, row.most) << row.name;
    EXPECT_LE(status.relative_residual[0], 1e-6) << row.name;
  }
}

// The table of 32^3 and 64^3: run with --gtest_also_run_disabled_tests. Twice the cells, at most two iterations more.
TEST_F(GpuDiffusionIterations, DISABLED_Table) {
  for (const Row& row : rows()) {
    const SolverStatus coarse = solve(32, row.medium), fine = solve(64, row.medium);
    std::printf("%-32s 32^3: %2d  64^3: %2d  true residual %.1e\n", row.name.c_str(), coarse.iterations,
                fine.iterations, fine.relative_residual[0]);
    EXPECT_TRUE(fine.converged) << row.name << ": " << fine.reason;
    EXPECT_LE(fine.iterations, 16) << row.name;
    EXPECT_LE(fine.iterations, coarse.iterations + 2) << row.name;
  }
}

}  // namespace
}  // namespace alabaster

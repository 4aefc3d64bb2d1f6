// Every pass of the multigrid against its double-precision twin.
#include <random>
#include <set>

#include "support/device.h"
#include "support/diffusion_problems.h"

namespace alabaster {
namespace {

constexpr double bf16_digits = 0x1p-8 + 1e-4;

class GpuMultigrid : public GpuTest {
 protected:
  DiffusionPasses passes{context};
};

struct Case {
  std::string name;
  Mesh mesh;
  twin::MaterialField medium;
};

std::vector<Case> cases() {
  std::vector<Case> list;
  const Mesh tilted_plate = transformed(box({1, 0.02f, 0.9f}), rotation({1, 2, 3}, 17));
  list.push_back({"ball", icosphere(3, 0.5f), checker(0.02, 1, 1)});
  list.push_back({"checker 1e4", icosphere(3, 0.5f), checker(0.02, 1e4, 0.13, 3)});
  list.push_back({"plate", tilted_plate, checker(0.02, 1, 1)});
  list.push_back({"needle", cylinder(0.012f, 1, 8), checker(0.02, 1, 1)});
  list.push_back({"odd sizes", box({1, 0.37f, 0.71f}), checker(0.02, 100, 0.2)});
  return list;
}

TEST_F(GpuMultigrid, BricksHoldEveryActiveCellAndNoOther) {
  const glm::ivec3 n(36, 22, 9), width(4 * DIFFUSION_BRICK_X, DIFFUSION_BRICK_Y, 1);
  std::mt19937 random(5);
  std::vector<std::uint8_t> active(std::size_t(n.x) * n.y * n.z);
  std::set<std::uint32_t> expected;
  for (std::size_t i = 0; i < active.size(); ++i) {
    active[i] = random() % 47 == 0;
    const glm::ivec3 brick = glm::ivec3(i % n.x, i / n.x % n.y, i / n.x / n.y) / width;
    if (active[i]) expected.insert(std::uint32_t(brick.x | brick.y << 10 | brick.z << 20));
  }
  const BrickList bricks = make_bricks(context, n, active);
  std::vector<std::uint32_t> listed = gpu::download<std::uint32_t>(context, bricks.packed);
  ASSERT_EQ(listed.size(), std::size_t(bricks.count));
  EXPECT_EQ(bricks.count * 8 % DIFFUSION_GROUP, 0);  // whole workgroups: the rest are none
  std::erase(listed, std::uint32_t(DIFFUSION_NO_BRICK));
  EXPECT_EQ(std::set<std::uint32_t>(listed.begin(), listed.end()), expected);
  EXPECT_EQ(listed.size(), expected.size());

  const BrickList columns = make_columns(context, n, active, 4);
  EXPECT_EQ(columns.count * 8 % DIFFUSION_GROUP, 0);
  std::multiset<std::uint32_t> walked;
  for (const std::uint32_t column : gpu::download<std::uint32_t>(context, columns.packed)) {
    const std::uint32_t lowest = column >> 15 & 1023, layers = column >> 25;
    EXPECT_LE(layers, 4u);
    for (std::uint32_t z = lowest; z < lowest + layers; ++z)
      walked.insert((column & 127) | (column >> 7 & 255) << 10 | z << 20);
  }
  EXPECT_EQ(walked, (std::multiset<std::uint32_t>(expected.begin(), expected.end())));
}

TEST_F(GpuMultigrid, HierarchyEqualsTwin) {
  for (const Case& test : cases()) {
    SCOPED_TRACE(test.name);
    const CutCells cells = gridded(test.mesh, 30);
    const twin::Problem first = twin::assemble(cells, test.medium, 2.6);
    const twin::Problem second = twin::assemble(cells, checker(0.1, 10, 0.3, 1), 2.6);
    Multigrid multigrid(context, passes, first.a.grid.n, 2, active_cells(first.a));
    std::vector<float> stencil = pack_finest(first.a), other = pack_finest(second.a);
    stencil.insert(stencil.end(), other.begin(), other.end());
    gpu::upload(context, multigrid.finest().stencil, stencil);
    multigrid.set_up();
    int channel = 0;
    for (const twin::Problem* problem : {&first, &second}) {
      const twin::Multigrid expected(problem->a);
      ASSERT_EQ(multigrid.levels().size(), expected.levels().size());
      for (std::size_t l = 0; l < expected.levels().size(); ++l) {
        const twin::Operator& a = expected.levels()[l].a;
        const std::vector<float> inverse = gpu::download<float>(context, multigrid.levels()[l].inverse_l1);
        EXPECT_LT(worst_difference(unpack(inverse, a.grid, 0, 1, channel), expected.levels()[l].inverse_l1),
                  l == 0 ? bf16_digits : 1e-4)
            << l;
        if (l == 0) {
          const PackedStencil packed =
              unpack_pairs(gpu::download<std::uint32_t>(context, multigrid.pairs()), a.grid, channel);
          EXPECT_TRUE(packed.symmetric);
          EXPECT_LT(worst_difference(packed.inverse_l1, expected.levels()[l].inverse_l1), bf16_digits);
          for (int k : a.couplings) EXPECT_LT(worst_difference(packed.a.a[k], a.a[k]), bf16_digits) << k;
          EXPECT_LT(worst_difference(packed.a.a[twin::diagonal], a.a[twin::diagonal]), bf16_digits);
        }
        if (l > 0) {
          const std::vector<float> got = gpu::download<float>(context, multigrid.levels()[l].stencil);
          for (int k = 0; k < DIFFUSION_ROW_SUM; ++k)
            EXPECT_LT(worst_difference(unpack(got, a.grid, k, DIFFUSION_COARSE_ENTRIES, channel), a.a[k]), 1e-4)
                << l << " entry " << k;
          twin::Vector sums, ones(a.grid.size(), 1.0);
          a.apply(ones, sums);
          EXPECT_LT(worst_difference(unpack(got, a.grid, DIFFUSION_ROW_SUM, DIFFUSION_COARSE_ENTRIES, channel), sums),
                    1e-4)
              << l << " row sums";
        }
        if (l + 1 < expected.levels().size()) {
          const std::vector<float> got = gpu::download<float>(context, multigrid.levels()[l].weights);
          const twin::Interpolation& p = expected.interpolations()[l];
          for (int k = 0; k < DIFFUSION_WEIGHTS; ++k)
            EXPECT_LT(worst_difference(unpack(got, p.coarse, k, DIFFUSION_WEIGHTS, channel), p.p[k]), 1e-4)
                << l << " weight " << k;
        }
      }
      ++channel;
    }
  }
}

// smooth, residual, restrict, prolong and direct, on every level.
TEST_F(GpuMultigrid, CycleEqualsTwin) {
  for (const Case& test : cases()) {
    SCOPED_TRACE(test.name);
    const twin::Problem problem = twin::assemble(gridded(test.mesh, 30), test.medium, 2.6);
    Multigrid multigrid(context, passes, problem.a.grid.n, 1, active_cells(problem.a));
    gpu::upload(context, multigrid.finest().stencil, pack_finest(problem.a));
    multigrid.set_up();
    twin::Multigrid expected(problem.a);
    PackedStencil packed = unpack_pairs(gpu::download<std::uint32_t>(context, multigrid.pairs()), problem.a.grid, 0);
    expected.smooth_with(0, std::move(packed.a), std::move(packed.inverse_l1));
    twin::Vector r = random_on(problem.a, 7), first = r, z;
    for (std::size_t i = 0; i < r.size(); ++i)
      first[i] *= multigrid.first_omega() * expected.levels().front().inverse_l1[i];
    gpu::upload(context, multigrid.finest().b, pack({&r}, problem.a.grid));
    gpu::upload(context, multigrid.finest().x, pack({&first}, problem.a.grid));
    const gpu::Buffer partials(context, multigrid.bricks().count * sizeof(float), "partials");
    gpu::Commands commands(context);
    commands.fill(partials);
    const gpu::Image& result = multigrid.record_cycle(commands, partials);
    commands.submit();
    expected.precondition(r, z);
    EXPECT_LT(worst_difference(unpack(gpu::download<float>(context, result), problem.a.grid, 0, 1, 0), z), 1e-4);
    double sum = 0;
    for (float v : gpu::download<float>(context, partials)) sum += v;
    EXPECT_NEAR(sum, twin::dot(r, z), 1e-4 * twin::dot(r, z));
  }
}

// Small changes of the medium keep the coarse levels, changes that add up to more do not; either way the solution is
// the new medium's.
TEST_F(GpuMultigrid, RefreshKeepsCoarseLevelsWithinAFactor) {
  const CutCells cells = gridded(icosphere(3, 0.5f), 30);
  const auto problem_of = [&](double contrast) { return twin::assemble(cells, checker(0.02, contrast, 0.4), 2.6); };
  const twin::Problem first = problem_of(1);
  Multigrid multigrid(context, passes, first.a.grid.n, 1, active_cells(first.a));
  Pcg pcg(context, passes, multigrid);
  std::vector<int> generations, iterations;
  for (const double contrast : {1.0, 1.2, 1.4, 1.9, 2.0}) {
    const twin::Problem problem = problem_of(contrast);
    gpu::upload(context, multigrid.finest().stencil, pack_finest(problem.a));
    multigrid.refresh();
    generations.push_back(multigrid.generation());
    twin::Vector b = problem.facet_conductance;
    gpu::upload(context, pcg.rhs(), pack({&b}, problem.a.grid));
    pcg.clear_solution();
    const SolverStatus status = pcg.solve();
    EXPECT_TRUE(status.converged) << status.reason;
    iterations.push_back(status.iterations);
    twin::Multigrid reference(problem.a);
    const twin::Solution expected = twin::solve_pcg(reference, b, 1e-6, 100);
    EXPECT_LT(
        worst_difference(unpack(gpu::download<float>(context, pcg.solution()), problem.a.grid, 0, 1, 0), expected.x),
        2e-5)
        << contrast;
  }
  EXPECT_EQ(generations, (std::vector<int>{1, 1, 1, 2, 2}));
  EXPECT_LE(iterations[2], iterations[0] + 1);
}

TEST_F(GpuMultigrid, SolvesLikeTheTwin) {
  for (const Case& test : cases()) {
    SCOPED_TRACE(test.name);
    const CutCells cells = gridded(test.mesh, 30);
    const twin::Problem problem = twin::assemble(cells, test.medium, 2.6);
    Multigrid multigrid(context, passes, problem.a.grid.n, 1, active_cells(problem.a));
    gpu::upload(context, multigrid.finest().stencil, pack_finest(problem.a));
    multigrid.set_up();
    Pcg pcg(context, passes, multigrid);
    twin::Vector b = problem.facet_conductance;
    gpu::upload(context, pcg.rhs(), pack({&b}, problem.a.grid));
    const SolverStatus status = pcg.solve();
    EXPECT_TRUE(status.converged) << status.reason;
    twin::Multigrid reference(problem.a);
    const twin::Solution expected = twin::solve_pcg(reference, b, 1e-6, 100);
    EXPECT_LE(std::abs(status.iterations - expected.iterations), 2);
    twin::Vector x = unpack(gpu::download<float>(context, pcg.solution()), problem.a.grid, 0, 1, 0);
    const twin::Vector rest = unpack(gpu::download<float>(context, pcg.solution_rest()), problem.a.grid, 0, 1, 0);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += rest[i];
    twin::Vector r;
    problem.a.apply(x, r);
    for (std::size_t i = 0; i < r.size(); ++i) r[i] = b[i] - r[i];
    const double residual = std::sqrt(twin::dot(r, r) / twin::dot(b, b));
    EXPECT_LT(residual, 1.2e-6);
    EXPECT_NEAR(residual, status.relative_residual[0], 0.2e-6);
  }
}

}  // namespace
}  // namespace alabaster

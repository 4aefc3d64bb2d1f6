// The solver's passes one at a time, two channels, on every level they run on, against the double-precision twin.
#include <bit>

#include "support/device.h"
#include "support/diffusion_problems.h"

namespace alabaster {
namespace {

constexpr double close = 2e-5;  // of the largest entry; the coarse operators themselves are compared elsewhere

class GpuDiffusionVectors : public GpuTest {
 protected:
  GpuDiffusionVectors() {
    std::vector<float> stencil;
    for (const twin::Problem& problem : problems)
      for (float v : pack_finest(problem.a)) stencil.push_back(v);
    gpu::upload(context, multigrid.finest().stencil, stencil);
    multigrid.set_up();
    for (const twin::Problem& problem : problems) expected.emplace_back(problem.a);
  }

  const twin::Operator& matrix(std::size_t l, int channel) const { return expected[channel].levels()[l].a; }
  std::vector<twin::Vector> random(std::size_t l, unsigned seed) const {
    return {random_on(matrix(l, 0), seed), random_on(matrix(l, 1), seed + 100)};
  }
  gpu::Image image(std::size_t l, const std::vector<twin::Vector>& channels) {
    gpu::Image made = packed_image(context, matrix(l, 0).grid.n, 2, 1, "test");
    std::vector<float> texels;
    for (const twin::Vector& v : channels)
      for (float value : pack({&v}, matrix(l, 0).grid)) texels.push_back(value);
    gpu::upload(context, made, texels);
    return made;
  }
  void expect(const gpu::Image& got, std::size_t l, int channel, const twin::Vector& wanted, const char* name) {
    EXPECT_LT(worst_difference(unpack(gpu::download<float>(context, got), matrix(l, 0).grid, 0, 1, channel), wanted),
              close)
        << name << ", level " << l << ", channel " << channel;
  }
  /// The reciprocal l1 norms that the device has, in bf16.
  twin::Vector inverse_l1(std::size_t l, int channel) {
    const std::vector<float> all = gpu::download<float>(context, multigrid.levels()[l].inverse_l1);
    return unpack(all, matrix(l, 0).grid, 0, 1, channel);
  }
  /// Of a channel; a pass's next sums follow after both channels' first. `each`: as many partial sums a channel.
  void expect_sum(int place, double wanted, const char* name, std::size_t each) {
    const std::vector<float> all = gpu::download<float>(context, partials);
    double sum = 0;
    for (std::size_t i = 0; i < each; ++i) sum += all[place * each + i];
    EXPECT_NEAR(sum, wanted, close * std::abs(wanted) + 1e-4) << name << ", " << place;
  }
  void run(const gpu::Pass& pass, std::size_t l, std::vector<gpu::Binding> bindings, float omega = 0,
           std::size_t threads_of = 0) {
    const std::size_t coarse = std::min(l + 1, multigrid.levels().size() - 1);
    const bool walks = &pass == &passes.smooth[1] || &pass == &passes.smooth_dot || &pass == &passes.defect[1] ||
                       &pass == &passes.apply_dot || &pass == &passes.start;
    bindings.push_back({"bricks", walks ? multigrid.columns().packed : multigrid.bricks(l + threads_of).packed});
    gpu::Commands commands(context);
    commands.dispatch(pass, walks ? multigrid.column_threads() : multigrid.threads(l + threads_of), bindings,
                      LevelPush{multigrid.levels()[l].cells, multigrid.levels()[coarse].cells, omega});
    commands.submit();
  }

  DiffusionPasses passes{context};
  // A thin tilted plate with slivers and blocks of another medium in it.
  CutCells cells = gridded(transformed(box({1, 0.08f, 0.9f}), rotation({1, 2, 3}, 17)), 40);
  std::vector<twin::Problem> problems{twin::assemble(cells, checker(0.02, 1e4, 0.13, 3), 2.6),
                                      twin::assemble(cells, checker(0.1, 1, 1, 0.5), 2.6)};
  Multigrid multigrid{context, passes, problems[0].a.grid.n, 2, active_cells(problems[0].a)};
  std::vector<twin::Multigrid> expected;
  gpu::Buffer partials = gpu::make_buffer(context, std::vector<float>(6 * multigrid.bricks().count), "partials");
};

TEST_F(GpuDiffusionVectors, SmoothDefectAndResidualEqualTwin) {
  for (std::size_t l = 0; l + 1 < multigrid.levels().size(); ++l) {
    const std::vector<twin::Vector> x = random(l, 1), b = random(l, 2);
    const gpu::Image on_x = image(l, x), on_b = image(l, b), smoothed = image(l, x), defect = image(l, x),
                     residual = image(l, x);
    MultigridLevel& level = multigrid.levels()[l];
    run(l == 0 ? passes.smooth_dot : passes.smooth[0], l,
        {{"stencil", level.stencil},
         {"inverse_l1", level.inverse_l1},
         {"pairs", multigrid.pairs()},
         {"x", on_x},
         {"partials", partials},
         {"b", on_b},
         {"smoothed", smoothed}},
        0.7f);
    run(passes.defect[l == 0], l,
        {{"stencil", level.stencil},
         {"inverse_l1", level.inverse_l1},
         {"pairs", multigrid.pairs()},
         {"x", on_x},
         {"b", on_b},
         {"defect", defect}});
    run(passes.residual[l == 0], l, {{"stencil", level.stencil}, {"x", on_x}, {"b", on_b}, {"residual", residual}});
    for (int c = 0; c < 2; ++c) {
      twin::Vector r, s = x[c];
      matrix(l, c).apply(x[c], r);
      for (std::size_t i = 0; i < r.size(); ++i) r[i] = b[c][i] - r[i];
      expect(residual, l, c, r, "residual");
      twin::Vector inverse = inverse_l1(l, c);
      if (l == 0) {
        const PackedStencil packed =
            unpack_pairs(gpu::download<std::uint32_t>(context, multigrid.pairs()), matrix(0, c).grid, c);
        packed.a.apply(x[c], r);
        for (std::size_t i = 0; i < r.size(); ++i) r[i] = b[c][i] - r[i];
        inverse = packed.inverse_l1;
      }
      for (std::size_t i = 0; i < r.size(); ++i) s[i] += double(0.7f) * inverse[i] * r[i];
      expect(defect, l, c, r, "defect");
      expect(smoothed, l, c, s, "smooth");
      if (l == 0) expect_sum(c, twin::dot(b[c], s), "smooth", multigrid.columns().count);
    }
  }
}

TEST_F(GpuDiffusionVectors, RestrictAndProlongEqualTwin) {
  for (std::size_t l = 0; l + 1 < multigrid.levels().size(); ++l) {
    const std::vector<twin::Vector> r = random(l, 3), x = random(l, 4), e = random(l + 1, 5);
    const gpu::Image on_r = image(l, r), on_x = image(l, x), on_e = image(l + 1, e), b = image(l + 1, e),
                     first = image(l + 1, e);
    MultigridLevel &level = multigrid.levels()[l], &coarse = multigrid.levels()[l + 1];
    run(passes.restrict_residual, l,
        {{"residual", on_r}, {"weights", level.weights}, {"inverse_l1", coarse.inverse_l1}, {"b", b}, {"x", first}},
        0.6f, 1);
    run(passes.prolong, l, {{"weights", level.weights}, {"correction", on_e}, {"x", on_x}}, 0, 1);
    for (int c = 0; c < 2; ++c) {
      const twin::Interpolation& p = expected[c].interpolations()[l];
      twin::Vector wanted, up = x[c];
      p.restrict_to(r[c], wanted);
      p.prolong_add(e[c], up);
      expect(b, l + 1, c, wanted, "restrict");
      const twin::Vector inverse = inverse_l1(l + 1, c);
      for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i] *= double(0.6f) * inverse[i];
      expect(first, l + 1, c, wanted, "restrict's first smoothing");
      expect(on_x, l, c, up, "prolong");
    }
  }
}

TEST_F(GpuDiffusionVectors, DriftIsTheLargestFactorBetweenStencils) {
  std::vector<float> stencil = gpu::download<float>(context, multigrid.finest().stencil);
  const std::vector<std::uint32_t> pairs = gpu::download<std::uint32_t>(context, multigrid.pairs());
  const int nx = multigrid.finest().cells.x;
  std::mt19937 engine(9);
  std::uniform_real_distribution<float> factor(0.4f, 1.3f);
  for (float& v : stencil) v *= factor(engine);
  gpu::upload(context, multigrid.finest().stencil, stencil);
  double wanted = 1;
  for (std::size_t row = 0; row < stencil.size(); row += 4 * nx)
    for (int x = 0; x < nx; ++x) {
      const float* cell = &stencil[row + x];
      const double none = DIFFUSION_CONNECTED * (double(cell[0]) + cell[nx] + cell[2 * nx]);
      for (int entry = 0; entry < 4; ++entry) {
        const double now = cell[entry * nx], then = std::bit_cast<float>(pairs[row + entry * nx + x] << 16);
        if (std::max(now, then) > none)
          wanted = std::max(wanted, std::max(now, then) / std::max(std::min(now, then), none));
      }
    }
  const gpu::Buffer factors = gpu::make_buffer(context, std::vector<float>(2 * multigrid.bricks().count), "factors");
  run(passes.drift, 0, {{"stencil", multigrid.finest().stencil}, {"pairs", multigrid.pairs()}, {"factors", factors}});
  const std::vector<float> got = gpu::download<float>(context, factors);
  EXPECT_GT(wanted, 2);
  EXPECT_NEAR(*std::max_element(got.begin(), got.end()), wanted, 0.01 * wanted);  // bf16
}

TEST_F(GpuDiffusionVectors, DirectIsTheProductWithTheInverse) {
  const std::size_t l = multigrid.levels().size() - 1;
  const glm::ivec3 n = multigrid.levels()[l].cells;
  const int nx = (n.x + 3) / 4 * 4, count = nx * n.y * n.z;
  std::mt19937 engine(3);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<float> inverse(std::size_t(2) * count * count);
  for (int c = 0; c < 2; ++c)
    for (int row = 0; row < count; ++row)
      for (int k = 0; k <= row; ++k)
        inverse[(std::size_t(c) * count + row) * count + k] = inverse[(std::size_t(c) * count + k) * count + row] =
            uniform(engine);
  const std::vector<twin::Vector> b = random(l, 6);
  const gpu::Image on_b = image(l, b), x = image(l, b);
  const gpu::Buffer on_inverse = gpu::make_buffer(context, inverse, "inverse");
  gpu::Commands commands(context);
  commands.dispatch(passes.direct, {count / 4, 2, 1}, {{"inverse", on_inverse}, {"b", on_b}, {"x", x}},
                    LevelPush{n, n, 0});
  commands.submit();
  const std::vector<float> got = gpu::download<float>(context, x);
  for (int c = 0; c < 2; ++c) {
    const std::vector<float> packed = pack({&b[c]}, matrix(l, 0).grid);
    for (int row = 0; row < count; ++row) {
      double sum = 0;
      for (int k = 0; k < count; ++k) sum += double(inverse[(std::size_t(c) * count + row) * count + k]) * packed[k];
      ASSERT_NEAR(got[c * count + row], sum, 1e-4) << c << " row " << row;
    }
  }
}

TEST_F(GpuDiffusionVectors, StepsOfTheConjugateGradientsEqualTwin) {
  const std::vector<twin::Vector> x = random(0, 7), p = random(0, 8), b = random(0, 9);
  std::vector<CgScalars> scalars(2);
  scalars[0].alpha = 0.3f, scalars[1].alpha = -1.7f;
  scalars[0].beta = 0.9f, scalars[1].beta = 0;
  const gpu::Buffer on_scalars = gpu::make_buffer(context, scalars, "scalars");
  MultigridLevel& level = multigrid.finest();
  const gpu::Image on_x = image(0, x), on_p = image(0, p), on_b = image(0, b);

  run(passes.norm, 0, {{"partials", partials}, {"x", on_x}});
  for (int c = 0; c < 2; ++c) expect_sum(c, twin::dot(x[c], x[c]), "norm", multigrid.bricks().count);

  const gpu::Image product = image(0, x);
  run(passes.apply_dot, 0, {{"stencil", level.stencil}, {"x", on_p}, {"partials", partials}, {"product", product}});
  std::vector<twin::Vector> q(2);
  for (int c = 0; c < 2; ++c) {
    matrix(0, c).apply(p[c], q[c]);
    expect(product, 0, c, q[c], "apply_dot");
    expect_sum(c, twin::dot(p[c], q[c]), "apply_dot", multigrid.columns().count);
  }

  const gpu::Image residual = image(0, x), z = image(0, x), on_rest = image(0, p);  // as large as x
  run(passes.start, 0,
      {{"stencil", level.stencil},
       {"x", on_x},
       {"rest", on_rest},
       {"partials", partials},
       {"inverse_l1", level.inverse_l1},
       {"b", on_b},
       {"r", residual},
       {"z", z}},
      0.8f);
  for (int c = 0; c < 2; ++c) {
    twin::Vector r, first;
    matrix(0, c).apply(x[c], r);
    for (std::size_t i = 0; i < r.size(); ++i) r[i] = b[c][i] - r[i] - q[c][i];
    expect(residual, 0, c, r, "start");
    expect_sum(c, twin::dot(r, r), "start", multigrid.columns().count);
    first = r;
    const twin::Vector inverse = inverse_l1(0, c);
    for (std::size_t i = 0; i < r.size(); ++i) first[i] *= inverse[i];
    expect_sum(2 + c, twin::dot(first, first), "start's scaled residual", multigrid.columns().count);
    expect_sum(4 + c, twin::dot(x[c], x[c]), "start's x . x", multigrid.columns().count);
    for (double& v : first) v *= double(0.8f);
    expect(z, 0, c, first, "start's smoothing");
  }

  const gpu::Image high = image(0, x), low = image(0, {twin::Vector(x[0].size()), twin::Vector(x[0].size())}),
                   r = image(0, b), next = image(0, b);
  run(passes.update, 0,
      {{"partials", partials},
       {"scalars", on_scalars},
       {"inverse_l1", level.inverse_l1},
       {"p", on_p},
       {"q", product},
       {"high", high},
       {"low", low},
       {"r", r},
       {"z", next}},
      0.8f);
  for (int c = 0; c < 2; ++c) {
    const double alpha = scalars[c].alpha;
    twin::Vector sum = x[c], rest = b[c], smoothed;
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += alpha * p[c][i], rest[i] -= alpha * q[c][i];
    expect(high, 0, c, sum, "update");
    expect(r, 0, c, rest, "update's residual");
    expect_sum(c, twin::dot(rest, rest), "update", multigrid.bricks().count);
    smoothed = rest;
    const twin::Vector inverse = inverse_l1(0, c);
    for (std::size_t i = 0; i < sum.size(); ++i) smoothed[i] *= double(0.8f) * inverse[i];
    expect(next, 0, c, smoothed, "update's smoothing");
    // high + low has more digits than one float: what was lost to rounding is in `low`.
    const twin::Lattice& grid = matrix(0, 0).grid;
    const twin::Vector h = unpack(gpu::download<float>(context, high), grid, 0, 1, c),
                       lost = unpack(gpu::download<float>(context, low), grid, 0, 1, c);
    double worst = 0;
    for (std::size_t i = 0; i < sum.size(); ++i) {
      const double exact = double(float(x[c][i])) + double(float(alpha * float(p[c][i])));
      worst = std::max(worst, std::abs(h[i] + lost[i] - exact));
    }
    EXPECT_LT(worst, 1e-12 + 1e-7 * 1.7) << "a step's own rounding at most";
  }

  const gpu::Buffer no_labels = gpu::make_buffer(context, std::vector<std::uint32_t>(4), "labels"),
                    no_lifts = gpu::make_buffer(context, std::vector<float>(1), "lifts");
  run(passes.direction[0], 0,
      {{"scalars", on_scalars}, {"labels", no_labels}, {"lifts", no_lifts}, {"z", on_x}, {"p", on_p}});
  for (int c = 0; c < 2; ++c) {
    twin::Vector wanted = x[c];
    for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i] += double(scalars[c].beta) * p[c][i];
    expect(on_p, 0, c, wanted, "direction");
  }
}

// islands, lifts, lift and direction of a checker's blocks, against Z E^-1 Z^T (r - A z) by the twin's matrix.
TEST_F(GpuDiffusionVectors, IslandsAreLiftedAsTheTwinsMatrixSays) {
  const Deflation& deflation = multigrid.deflation();
  const MultigridLevel& level = multigrid.finest();
  ASSERT_GT(deflation.count(), 20);
  const std::vector<twin::Vector> r = random(0, 11), z = random(0, 12);
  const gpu::Image on_r = image(0, r), on_z = image(0, z),
                   low = image(0, {twin::Vector(r[0].size()), twin::Vector(r[0].size())});
  std::vector<CgScalars> scalars(2);
  const gpu::Buffer on_scalars = gpu::make_buffer(context, scalars, "scalars");
  for (const bool start : {false, true}) {
    const gpu::Image lifted = image(0, z);
    gpu::Commands commands(context);
    commands.dispatch(passes.islands[start], {64 * std::min(deflation.pieces(), 7u), 1, 1},  // fewer groups than pieces
                      {{"pieces", deflation.piece_list()},
                       {"entries", deflation.entries()},
                       {"sums", deflation.sums()},
                       {"r", on_r},
                       {"z", on_z},
                       {"stencil", level.stencil}},
                      IslandPush{level.cells, deflation.pieces()});
    commands.dispatch(passes.lifts, {deflation.count(), 1, 1},
                      {{"islands", deflation.pieces_of()}, {"sums", deflation.sums()}, {"lifts", deflation.lifts()}},
                      LiftPush{static_cast<std::uint32_t>(deflation.count())});
    commands.submit();
    const std::vector<gpu::Binding> lifts{{"labels", deflation.labels()}, {"lifts", deflation.lifts()}};
    if (start) {
      run(passes.lift, 0, {lifts[0], lifts[1], {"high", lifted}, {"low", low}});
    } else {
      run(passes.direction[1], 0, {lifts[0], lifts[1], {"scalars", on_scalars}, {"z", on_z}, {"p", lifted}});
    }
    for (int c = 0; c < 2; ++c) {
      twin::Vector residual(r[c].size()), wanted = z[c];
      if (!start) matrix(0, c).apply(z[c], residual);
      for (std::size_t i = 0; i < residual.size(); ++i) residual[i] = r[c][i] - residual[i];
      twin::Deflation(matrix(0, c)).lift(residual, wanted);
      expect(lifted, 0, c, wanted, start ? "start" : "direction");
    }
  }
}

TEST_F(GpuDiffusionVectors, ReduceMovesTheScalarsOn) {
  const int count = 1000;  // more than a workgroup, not a multiple of it
  std::vector<float> values(2 * count);
  double sums[2] = {0, 0};
  for (int i = 0; i < 2 * count; ++i) {
    values[i] = 0.001f * static_cast<float>(i % 37);
    sums[i / count] += values[i];
  }
  const auto reduced = [&](std::vector<CgScalars> before, int mode, const std::vector<float>& parts) {
    const gpu::Buffer scalars = gpu::make_buffer(context, before, "scalars"),
                      parts_buffer = gpu::make_buffer(context, parts, "parts");
    gpu::Commands commands(context);
    commands.dispatch(passes.reduce, {64 * 2, 1, 1}, {{"partials", parts_buffer}, {"scalars", scalars}},
                      ReducePush{count, mode, 0});
    commands.submit();
    return gpu::download<CgScalars>(context, scalars);
  };
  CgScalars going{};
  going.tolerance = 0.1f, going.bb = 100, going.rho = 4, going.iterations = 3;
  CgScalars ended = going;
  ended.done = 1;
  std::vector<CgScalars> got = reduced({going, going}, DIFFUSION_REDUCE_START, values);
  for (int c = 0; c < 2; ++c) {
    EXPECT_NEAR(got[c].bb, sums[c], 1e-5 * sums[c]);
    EXPECT_EQ(got[c].iterations, 0);
  }
  got = reduced({going, ended}, DIFFUSION_REDUCE_BETA, values);
  EXPECT_NEAR(got[0].beta, sums[0] / 4, 1e-5 * sums[0]);
  EXPECT_NEAR(got[0].rho, sums[0], 1e-5 * sums[0]);
  EXPECT_EQ(got[1].beta, 0);
  got = reduced({going, ended}, DIFFUSION_REDUCE_ALPHA, values);
  EXPECT_NEAR(got[0].alpha, 4 / sums[0], 1e-5);
  EXPECT_EQ(got[1].alpha, 0);
  CgScalars near = going;
  near.target = near.tolerance, near.bb = 1e6f;  // goal 1e4, above the sums
  got = reduced({going, near}, DIFFUSION_REDUCE_RESIDUAL, values);
  EXPECT_NEAR(got[0].rr, sums[0], 1e-5 * sums[0]);
  EXPECT_EQ(got[0].iterations, 4);
  EXPECT_EQ(got[0].done, 0);
  EXPECT_EQ(got[1].done, 1);
  got = reduced({going, near}, DIFFUSION_REDUCE_TRUE, values);
  EXPECT_EQ(got[0].done, 0);
  EXPECT_EQ(got[1].done, 1);
  EXPECT_NEAR(got[0].true_rr, sums[0], 1e-5 * sums[0]);
  std::vector<float> broken = values;
  broken[5] = NAN;        // channel 0
  broken[count] = -1e6f;  // channel 1: p . A p below zero
  got = reduced({going, going}, DIFFUSION_REDUCE_ALPHA, broken);
  for (int c = 0; c < 2; ++c) {
    EXPECT_EQ(got[c].done, 2) << c;
    EXPECT_EQ(got[c].alpha, 0) << c;
  }
}

}  // namespace
}  // namespace alabaster

// Islands of more cells than one invocation may turn loops for: lavapipe ends a loop after 65535 turns and says
// nothing.
#include <random>

#include "diffusion/islands.h"
#include "support/diffusion_device.h"
#include "support/diffusion_problems.h"

namespace alabaster {
namespace {

class GpuDiffusionIslands : public GpuTest {};

constexpr glm::ivec3 cells{128, 96, 100};

/// A box whose middle layers conduct, poorly joined to those above and below. One empty cell of margin all around.
struct Layers {
  std::vector<float> stencil = std::vector<float>(std::size_t(DIFFUSION_FINEST_ENTRIES) * cells.x * cells.y * cells.z);

  static std::size_t at(int entry, glm::ivec3 c) {
    return c.x + std::size_t(cells.x) * (entry + DIFFUSION_FINEST_ENTRIES * (c.y + std::size_t(cells.y) * c.z));
  }
  static bool within(glm::ivec3 c) {
    return glm::all(glm::greaterThan(c, glm::ivec3(0))) && glm::all(glm::lessThan(c, cells - 1));
  }
  static bool middle(glm::ivec3 c) { return c.z >= 26 && c.z < 74; }

  template <class Visit>
  static void for_cells(Visit visit) {
    for (int z = 1; z + 1 < cells.z; ++z)
      for (int y = 1; y + 1 < cells.y; ++y)
        for (int x = 1; x + 1 < cells.x; ++x) visit(glm::ivec3(x, y, z));
  }

  Layers() {
    for_cells([&](glm::ivec3 c) {
      for (int axis = 0; axis < 3; ++axis) {
        glm::ivec3 below = c;
        --below[axis];
        if (within(below)) stencil[at(axis, c)] = middle(c) && middle(below) ? 1.f : 1e-4f;
      }
      stencil[at(DIFFUSION_REACTION, c)] = 1e-6f;
    });
  }
};

TEST_F(GpuDiffusionIslands, OfMoreThanALoopMayCount) {
  const Layers layers;
  const Islands islands = find_islands(cells, layers.stencil);
  ASSERT_FALSE(islands.spans.empty());
  ASSERT_GT(islands.spans.front().end - islands.spans.front().cells, 65535u * 8) << "the case that this tests";
  const gpu::Image stencil = packed_image(context, cells, 1, DIFFUSION_FINEST_ENTRIES, "stencil"),
                   r = packed_image(context, cells, 1, 1, "r"), z = packed_image(context, cells, 1, 1, "z");
  std::mt19937 engine(5);
  std::uniform_real_distribution<float> uniform(0, 1);  // all of one sign: a part left out shows
  std::vector<float> on_r(std::size_t(cells.x) * cells.y * cells.z), on_z = on_r;
  const auto cell = [](glm::ivec3 c) { return c.x + std::size_t(cells.x) * (c.y + std::size_t(cells.y) * c.z); };
  Layers::for_cells([&](glm::ivec3 c) { on_r[cell(c)] = uniform(engine), on_z[cell(c)] = uniform(engine); });
  gpu::upload(context, stencil, layers.stencil);
  gpu::upload(context, r, on_r);
  gpu::upload(context, z, on_z);

  std::vector<double> expected(islands.spans.size() + 1);
  Layers::for_cells([&](glm::ivec3 c) {
    const std::uint32_t label = islands.labels[cell(c)];
    if (label == 0) return;
    double sum = on_r[cell(c)] - double(layers.stencil[Layers::at(DIFFUSION_REACTION, c)]) * on_z[cell(c)];
    for (int axis = 0; axis < 3; ++axis)
      for (int up = 0; up < 2; ++up) {
        glm::ivec3 beyond = c;
        beyond[axis] += 2 * up - 1;
        if (!Layers::within(beyond)) continue;
        sum -= double(layers.stencil[Layers::at(axis, up ? beyond : c)]) * (double(on_z[cell(c)]) - on_z[cell(beyond)]);
      }
    expected[label] += sum * islands.spans[label - 1].weight;
  });

  const DiffusionPasses passes(context);
  const Deflation deflation(context, stencil, cells, {roughness(cells, layers.stencil)});
  gpu::Commands commands(context);
  commands.dispatch(passes.islands[0], {8 * deflation.pieces(), 1, 1},
                    {{"pieces", deflation.piece_list()},
                     {"entries", deflation.entries()},
                     {"sums", deflation.sums()},
                     {"r", r},
                     {"z", z},
                     {"stencil", stencil}},
                    IslandPush{cells, deflation.pieces()});
  commands.dispatch(passes.lifts, {deflation.count(), 1, 1},
                    {{"islands", deflation.pieces_of()}, {"sums", deflation.sums()}, {"lifts", deflation.lifts()}},
                    LiftPush{static_cast<std::uint32_t>(deflation.count())});
  commands.submit();
  const std::vector<float> lifts = gpu::download<float>(context, deflation.lifts());
  ASSERT_EQ(deflation.count(), islands.spans.size());
  for (std::size_t k = 1; k < expected.size(); ++k)
    EXPECT_NEAR(lifts[k], expected[k], 1e-4 * std::abs(expected[k])) << k;
}

// Blocks of two media in a ball; in half of it noise as well, so that each of the counts has something to count.
TEST_F(GpuDiffusionIslands, RoughnessEqualsTwin) {
  const auto blocks = [](glm::dvec3 p) {
    const bool dense = int(std::floor(p.x / 0.13) + std::floor(p.y / 0.13) + std::floor(p.z / 0.13)) & 1;
    return MediumPoint{dense ? glm::dvec3(2e3, 300, 30) : glm::dvec3(15), glm::dvec3(0)};
  };
  Body body(context, icosphere(3, 0.4f), 40, blocks, 3);
  Multigrid& multigrid = body.diffusion().multigrid();
  const gpu::Image& stencil = multigrid.finest().stencil;
  const glm::ivec3 n = multigrid.finest().cells;
  std::vector<float> values = gpu::download<float>(context, stencil);
  std::mt19937 engine(7);
  std::uniform_real_distribution<float> magnitude(-2, 2);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (i % n.x < std::size_t(n.x / 2)) values[i] *= std::pow(10.f, magnitude(engine));
  gpu::upload(context, stencil, values);

  const DiffusionPasses passes(context);
  const gpu::Buffer counts = gpu::make_buffer(context, std::vector<Roughness>(3), "counts");
  gpu::Commands commands(context);
  commands.dispatch(passes.rough, multigrid.column_threads(),
                    {{"bricks", multigrid.columns().packed}, {"stencil", stencil}, {"counts", counts}},
                    LevelPush{n, n});
  commands.submit();
  const std::vector<Roughness> found = gpu::download<Roughness>(context, counts);
  for (std::size_t c = 0; c < 3; ++c) {
    SCOPED_TRACE(c);
    const std::size_t each = values.size() / 3;
    const Roughness wanted = roughness(n, std::span(values).subspan(c * each, each));
    EXPECT_EQ(found[c].all, wanted.all);
    EXPECT_EQ(found[c].within, wanted.within);
    EXPECT_EQ(found[c].jumps, wanted.jumps);
    EXPECT_EQ(found[c].noisy, wanted.noisy);
    EXPECT_EQ(found[c].deep, wanted.deep);
    EXPECT_EQ(found[c].deep_jumps, wanted.deep_jumps);
    EXPECT_GT(wanted.all, wanted.within);
    EXPECT_GT(wanted.within, wanted.deep);
    EXPECT_GT(wanted.jumps, wanted.noisy);
    EXPECT_GT(wanted.jumps, wanted.deep_jumps);
    EXPECT_GT(std::min({wanted.noisy, wanted.deep, wanted.deep_jumps}), 1000u);
  }
}

// The surface cuts faces to nothing beside whole ones, in more than one cell in a hundred: that is no medium that
// jumps.
TEST_F(GpuDiffusionIslands, TheSurfaceAloneMakesNoMediumRough) {
  const Mesh ring = transformed(torus(0.4f, 0.1f, 96, 48), rotation({1, 2, 3}, 31));
  const auto rough = [&](const MediumField& medium) {
    return Body(context, ring, 64, medium).diffusion().multigrid().deflation().rough();
  };
  EXPECT_FALSE(rough(uniform_medium(0.02, 0.5)));
  EXPECT_TRUE(rough([](glm::dvec3 p) {
    const double kappa = int(std::floor(p.x / 0.1) + std::floor(p.y / 0.1) + std::floor(p.z / 0.1)) % 2 ? 0.02 : 2e-4;
    return MediumPoint{glm::dvec3(1 / (3 * kappa)), glm::dvec3(0)};
  }));
}

}  // namespace
}  // namespace alabaster

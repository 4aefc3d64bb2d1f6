// shared/procedural.h as the GPU runs it against the same source in double precision.
#include "scene/procedural.h"

#include <random>

#include "support/device.h"

namespace alabaster {
namespace {

class GpuProcedural : public GpuTest {};

TEST_F(GpuProcedural, MatchesDoublePrecision) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-1.5f, 1.5f), depth(-1e-3f, 3e-3f);
  std::vector<glm::vec4> points;
  for (int i = 0; i < 4000; ++i) points.push_back({unit(random), unit(random), unit(random), depth(random)});
  const gpu::Buffer in = gpu::make_buffer(context, points, "points");
  const gpu::Buffer out(context, points.size() * sizeof(glm::vec2), "shares");
  const gpu::Pass pass(context, "test/procedural.comp");
  struct Push {
    std::uint32_t count;
    ProceduralSolid solid;
  };
  for (std::uint32_t kind = 0; kind < solid_kinds; ++kind) {
    SCOPED_TRACE(solid_names[kind]);
    Push push{static_cast<std::uint32_t>(points.size()), usual_solid(kind)};
    push.solid.seed = 5;
    gpu::Commands commands(context);
    commands.dispatch(pass, {points.size(), 1, 1}, {{"points", in}, {"shares", out}}, push);
    commands.submit();
    const std::vector<glm::vec2> shares = gpu::download<glm::vec2>(context, out);
    int apart = 0;
    double mean = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const glm::dvec4 p(points[i]);
      for (unsigned part : {1u, 2u}) {
        const double exact =
            solid_share<double>(kind, 5, 1, 1, push.solid.depths.x, push.solid.depths.y, part, p.x, p.y, p.z, p.w);
        ASSERT_GE(exact, 0);
        ASSERT_LE(exact, 1);
        if (part == 1) mean += exact;
        apart += std::abs(shares[i][part - 1] - exact) > 1e-3;
      }
    }
    EXPECT_LE(apart, 4);  // points that rounding puts on the other side of a jump
    EXPECT_GT(mean, 0.02 * double(points.size()));
    EXPECT_LT(mean, 0.98 * double(points.size()));
  }
}

}  // namespace
}  // namespace alabaster

// The unit of the fluence, and the solution carried from one unit to the next.
#include "support/surface_passes.h"

namespace alabaster {
namespace {

using GpuDiffusionScale = SurfacePasses;

TEST_F(GpuDiffusionScale, ScaleIsThePowerOfTwoAboveTheLargestSource) {
  for (glm::vec3& g : gamma) g.z = 0;
  const gpu::Buffer light = gpu::make_buffer(context, gamma, "gamma_s");
  gpu::Commands commands(context);
  commands.dispatch(passes.scale, {256 * channels, 1, 1}, {{"gamma_s", light}, {"scales", scale_buffer}}, push());
  commands.submit();
  const std::vector<FluenceScale> got = gpu::download<FluenceScale>(context, scale_buffer);
  for (int c = 0; c < 2; ++c) {
    double largest = 0;
    for (std::size_t i = sides; i < gamma.size(); ++i)
      largest = std::max(largest, dsbc_source(double(gamma[i][c]), body.f_dt()));
    EXPECT_GT(got[c].unit, largest);
    EXPECT_LE(got[c].unit, 2 * largest);
    EXPECT_EQ(std::exp2(std::round(std::log2(got[c].unit))), got[c].unit);
    EXPECT_EQ(got[c].ratio, scales[c].unit / got[c].unit);
  }
  EXPECT_EQ(got[2].unit, 0);
  EXPECT_EQ(got[2].ratio, 0);
}

TEST_F(GpuDiffusionScale, RescaleCarriesTheSolutionIntoTheNewUnit) {
  Pcg& pcg = body.diffusion().pcg();
  std::vector<float> low = phi;
  for (float& v : low) v *= 1e-8f;
  gpu::upload(context, pcg.solution_rest(), low);
  for (int c = 0; c < channels; ++c) scales[c].ratio = c == 2 ? 0 : std::ldexp(1.f, 5 - 7 * c);
  const gpu::Buffer ratios = gpu::make_buffer(context, scales, "scales");
  const Multigrid& multigrid = body.diffusion().multigrid();
  gpu::Commands commands(context);
  commands.dispatch(passes.rescale, multigrid.threads(0),
                    {{"bricks", multigrid.bricks().packed},
                     {"scales", ratios},
                     {"high", pcg.solution()},
                     {"low", pcg.solution_rest()}},
                    push());
  commands.submit();
  const std::vector<float> high = gpu::download<float>(context, pcg.solution()),
                           rest = gpu::download<float>(context, pcg.solution_rest());
  for (std::size_t i = 0; i < phi.size(); ++i) {
    const float ratio = scales[i / volume.size()].ratio;
    ASSERT_EQ(high[i], ratio * phi[i]) << i;
    ASSERT_EQ(rest[i], ratio * low[i]) << i;
  }
}

}  // namespace
}  // namespace alabaster

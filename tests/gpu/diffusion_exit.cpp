#include "support/surface_passes.h"

namespace alabaster {
namespace {

using GpuDiffusionExit = SurfacePasses;

// With a query Gamma of its own; without and with light that goes straight through.
TEST_F(GpuDiffusionExit, ExitEqualsTwin) {
  std::vector<float> offsets;
  for (const glm::vec4& g : random_gradients()) offsets.push_back(0.1f * g.x);
  const gpu::Buffer facet_offsets = gpu::make_buffer(context, offsets, "offsets");
  std::vector<glm::vec3> through(2 * cut.size());
  for (std::size_t i = 0; i < through.size(); ++i) through[i] = {0.1f * float(i % 5), 0.2f * float(i % 3), 0.3f};
  const gpu::Buffer through_buffer = gpu::make_buffer(context, through, "through");
  const std::size_t first = 5;
  const gpu::Buffer sent = results<glm::vec3>(first + 2 * cut.size());
  const struct {
    SurfacePush surface;
    float exit_scale;
    std::uint32_t first;
  } exit_push{push(), 0.6f, first};
  for (bool straight : {false, true}) {
    gpu::Commands commands(context);
    commands.dispatch(passes.exit[straight], {2 * cut.size(), 1, 1},
                      {{"cut_index", domain.cut_index},
                       {"cut_cells", domain.cut_cells},
                       {"gamma_s", gamma_buffer},
                       {"query_gamma", query_buffer},
                       {"through", through_buffer},
                       {"facets", body.diffusion().facet_medium()},
                       {"scales", scale_buffer},
                       {"facet_offsets", facet_offsets},
                       {"phi", body.diffusion().pcg().solution()},
                       {"transmitted", sent}},
                      exit_push);
    commands.submit();
    const std::vector<glm::vec3> got = gpu::download<glm::vec3>(context, sent);
    Largest radiance;
    int clamped = 0;
    for (std::size_t i = 1; i < cut.size(); ++i)
      for (int side = 0; side < 2; ++side)
        for (int c = 0; c < channels && cut[i].side[side].area > 0; ++c) {
          const double own = fluence(cut[i].cell, c) + offsets[c * cut.size() + i], light = gamma_of(i, side, c);
          const double surface = dsbc_surface_fluence(own, dsbc_source(light, body.f_dt()), A, depth(i, side, c));
          const double bracket = query_bracket(surface, light * query_share(i, side), A, body.f_dt());
          clamped += bracket < 0;
          const double flux = body.f_dt() / 4 * std::max(bracket, 0.0) + (straight ? through[2 * i + side][c] : 0);
          radiance.add(got[first + 2 * i + side][c], flux * 0.6 / (M_PI * body.f_dt()));
        }
    EXPECT_GT(clamped, 0);
    EXPECT_LT(radiance.apart, 1e-5 * radiance.value);
  }
}

}  // namespace
}  // namespace alabaster

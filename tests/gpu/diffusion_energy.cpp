#include "support/surface_passes.h"

namespace alabaster {
namespace {

using GpuDiffusionEnergy = SurfacePasses;

TEST_F(GpuDiffusionEnergy, EnergyEqualsTwin) {
  const std::vector<float> absorption = [&] {
    std::vector<float> values(phi.size());
    std::uniform_real_distribution<float> uniform(0, 1);
    for (float& v : values) v = uniform(engine);
    return values;
  }();
  const gpu::Image absorption_image = packed_image(context, n, channels, 1, "absorption");
  gpu::upload(context, absorption_image, absorption);
  std::vector<float> offsets;
  for (const glm::vec4& g : random_gradients()) offsets.push_back(0.1f * g.x);
  const gpu::Buffer facet_offsets = gpu::make_buffer(context, offsets, "offsets"), sums = results<EnergySums>(channels);
  const Multigrid& multigrid = body.diffusion().multigrid();
  Pcg& pcg = body.diffusion().pcg();
  const struct {
    SurfacePush surface;
    int partials_per_channel;
  } energy_push{push(), pcg.partials_per_channel()};
  gpu::Commands commands(context);
  commands.dispatch(passes.absorbed, multigrid.threads(0),
                    {{"bricks", multigrid.bricks().packed},
                     {"partials", pcg.partials()},
                     {"volume", domain.volume},
                     {"absorption", absorption_image},
                     {"phi", pcg.solution()}},
                    LevelPush{n, n, 0});
  commands.dispatch(passes.energy, {256 * channels, 1, 1},
                    {{"cut_index", domain.cut_index},
                     {"cut_cells", domain.cut_cells},
                     {"gamma_s", gamma_buffer},
                     {"query_gamma", query_buffer},
                     {"facets", body.diffusion().facet_medium()},
                     {"scales", scale_buffer},
                     {"partials", pcg.partials()},
                     {"facet_offsets", facet_offsets},
                     {"phi", pcg.solution()},
                     {"sums", sums}},
                    energy_push);
  commands.submit();
  const std::vector<EnergySums> got = gpu::download<EnergySums>(context, sums);
  for (int c = 0; c < channels; ++c) {
    double in = 0, out = 0, absorbed = 0;
    for (std::size_t i = 0; i < volume.size(); ++i)
      absorbed += double(absorption[c * volume.size() + i]) * volume[i] * phi[c * volume.size() + i];
    for (std::size_t i = 1; i < cut.size(); ++i)
      for (int side = 0; side < 2; ++side) {
        const double area = cut[i].side[side].area * h * h, own = fluence(cut[i].cell, c) + offsets[c * cut.size() + i];
        const double light = gamma_of(i, side, c), boundary = dsbc_source(light, body.f_dt()), d = depth(i, side, c);
        // phi_b of phi_b + 2 A kappa (phi_b - phi) / d = q; the query's bracket is what leaves through F_dt / 4.
        const double surface = (2 * A * own + d * boundary) / (2 * A + d);
        const double query = light * query_share(i, side);
        // What the boundary condition lets in, and what the query lets out.
        const double leaves = body.f_dt() / 4 * query_bracket(surface, query, A, body.f_dt());
        in += area * ((boundary - surface) / (2 * A) + leaves);
        out += area * leaves;
      }
    EXPECT_NEAR(got[c].in_, in, 1e-5 * in);
    EXPECT_NEAR(got[c].out_, out, 1e-4 * in);
    EXPECT_NEAR(got[c].absorbed, absorbed, 1e-5 * absorbed);
  }
}

}  // namespace
}  // namespace alabaster

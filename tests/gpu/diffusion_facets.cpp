// The light and the deferred correction of each cell, and the right-hand side they make.
#include "support/surface_passes.h"

namespace alabaster {
namespace {

using GpuDiffusionFacets = SurfacePasses;

TEST_F(GpuDiffusionFacets, FacetsAndSourceEqualTwin) {
  const std::vector<glm::vec4> gradient = random_gradients();
  const gpu::Image gradients = table(gradient), on_points = points(), face_fluxes = table(2 * channels);
  const Rim& rim = body.diffusion().rim();
  ASSERT_GT(rim.cells, 100);
  const gpu::Buffer cell_sources = results<float>((cut.size() + rim.cells) * channels),
                    facet_offsets = results<float>(cut.size() * channels);
  const Multigrid& multigrid = body.diffusion().multigrid();
  const std::vector<float> stencil = gpu::download<float>(context, body.diffusion().multigrid().finest().stencil);
  const std::vector<glm::vec4> B = entries(body.diffusion().facet_conductances());
  const gpu::Image power_image = packed_image(context, n, channels, 1, "power in the cells");
  std::vector<float> power(volume.size() * channels);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (std::size_t i = 0; i < power.size(); ++i) power[i] = volume[i % volume.size()] > 0 ? uniform(engine) : 0;
  gpu::upload(context, power_image, power);
  const SourcePush source_push{n, static_cast<int>(cut.size()), rim.cells, rim.texels, {0.5f, 2.f, 30.f}};
  for (const auto& [corrected, in_cells] : {std::pair(false, false), {true, false}, {false, true}, {true, true}}) {
    gpu::Image& rhs = body.diffusion().pcg().rhs();
    gpu::Commands commands(context);
    commands.dispatch(passes.facets[corrected], {cut.size(), channels, 1},
                      {{"cut_index", domain.cut_index},
                       {"cut_cells", domain.cut_cells},
                       {"conductances", body.diffusion().facet_conductances()},
                       {"gamma_s", gamma_buffer},
                       {"facets", body.diffusion().facet_medium()},
                       {"scales", scale_buffer},
                       {"gradients", gradients},
                       {"points", on_points},
                       {"stencil", body.diffusion().multigrid().finest().stencil},
                       {"cell_sources", cell_sources},
                       {"face_fluxes", face_fluxes},
                       {"facet_offsets", facet_offsets}},
                      push());
    if (corrected)
      commands.dispatch(passes.rim, {rim.cells, channels, 1},
                        {{"rim_cells", rim.cell_table}, {"face_fluxes", face_fluxes}, {"cell_sources", cell_sources}},
                        source_push);
    commands.clear(rhs);
    if (in_cells)
      commands.dispatch(passes.power, multigrid.threads(0),
                        {{"bricks", multigrid.bricks().packed},
                         {"scales", scale_buffer},
                         {"volume_power", power_image},
                         {"rhs", rhs}},
                        source_push);
    commands.dispatch(passes.source[corrected][in_cells], {rim.texels, channels, 1},
                      {{"rim_texels", rim.texel_table}, {"cell_sources", cell_sources}, {"rhs", rhs}}, source_push);
    commands.submit();
    const std::vector<float> got = gpu::download<float>(context, rhs);
    const std::vector<float> below = gpu::download<float>(context, facet_offsets);
    for (int c = 0; c < channels; ++c) {
      std::vector<double> b(volume.size(), 0.0);
      const auto carried = [&](std::size_t i, glm::dvec3 away) {
        const glm::dvec4 g(gradient[c * cut.size() + i]);
        return std::clamp(glm::dot(glm::dvec3(g), away), -0.25 * std::abs(g.w), 0.25 * std::abs(g.w));
      };
      Largest offset, source;
      for (std::size_t i = 1; i < cut.size(); ++i) {
        const GpuFacet& facet = cut[i].facet;
        const double length = glm::length(glm::dvec3(facet.area_vector));
        double o = 0;
        if (corrected && length > 0.5 * facet.area) {
          const glm::dvec3 normal = glm::dvec3(facet.area_vector) / length,
                           away = glm::dvec3(facet.centre) - glm::dvec3(cut[i].centre);
          o = carried(i, away - normal * glm::dot(away, normal));
        }
        offset.add(below[c * cut.size() + i], o);
        b[at(cut[i].cell)] += B[c * cut.size() + i].x * (q(i, c, true) - o) / scales[c].unit;
      }
      // Every face once, what the one side gains the other loses.
      if (corrected)
        for_cells([&](glm::ivec3 upper) {
          for (int axis = 0; axis < 3; ++axis) {
            glm::ivec3 lower = upper;
            --lower[axis];
            const double T = stencil[upper.x + n.x * (axis + std::size_t(4) * (upper.y + n.y * (upper.z + c * n.z)))];
            if (!inside(lower) || T == 0) continue;
            const glm::dvec3 face(cut[index(upper)].low_face_centre[axis]);
            const auto towards_face = [&](glm::ivec3 cell) {
              if (index(cell) == 0) return 0.0;
              glm::dvec3 away = face - centre(cell);
              away[axis] = 0;
              return carried(index(cell), away);
            };
            const double flux = T * (towards_face(lower) - towards_face(upper)) / scales[c].unit;
            b[at(upper)] += flux;
            b[at(lower)] -= flux;
          }
        });
      for (std::size_t i = 0; i < b.size(); ++i) {
        if (in_cells) b[i] += double(source_push.per_power[c]) * power[c * b.size() + i] / scales[c].unit;
        source.add(got[c * b.size() + i], b[i]);
      }
      EXPECT_EQ(offset.value > 0, corrected);
      EXPECT_LE(offset.apart, 1e-5 * offset.value) << c;
      EXPECT_GT(source.value, 0);
      EXPECT_LT(source.apart, 1e-5 * source.value) << c << " corrected " << corrected;
    }
  }
}

TEST_F(GpuDiffusionFacets, ConductancesEqualTwin) {
  const std::vector<glm::vec4> got = entries(body.diffusion().facet_conductances());
  for (int c = 0; c < channels; ++c) {
    Largest B, share, robin;
    for (std::size_t i = 0; i < cut.size(); ++i) {
      const glm::vec4 mine = got[c * cut.size() + i];
      double side[2];
      for (int k = 0; k < 2; ++k)
        side[k] = cut[i].side[k].area * h / body.diffusion().kappa_scale()[c] / (2 * A + depth(i, k, c));
      const double k = facets[i].kappa[c], sum = side[0] + side[1];
      B.add(mine.x, sum);
      share.add(mine.y, sum > 0 ? side[0] / sum : 0);
      robin.add(mine.z, 2 * A * k / h);
    }
    EXPECT_LT(B.apart, 1e-5 * B.value) << c;
    EXPECT_LT(share.apart, 1e-5) << c;
    EXPECT_GT(share.value, 0.9) << c;
    EXPECT_LT(robin.apart, 1e-5 * robin.value) << c;
  }
}

// A light in the cells leaves nothing behind in the right-hand side of the next without.
TEST_F(GpuDiffusionFacets, LightWithoutPowerFollowsLightWithPower) {
  const gpu::Image power = packed_image(context, n, channels, 1, "power");
  std::vector<float> values(volume.size() * channels);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = volume[i % volume.size()];
  gpu::upload(context, power, values);
  FacetLight plain(gamma_buffer, sides), inner(gamma_buffer, sides);
  inner.volume = &power;
  body.diffusion().forget();
  body.diffusion().solve(plain);
  const std::vector<float> before = gpu::download<float>(context, body.diffusion().pcg().rhs());
  body.diffusion().solve(inner);
  EXPECT_NE(gpu::download<float>(context, body.diffusion().pcg().rhs()), before);
  body.diffusion().forget();
  body.diffusion().solve(plain);
  EXPECT_EQ(gpu::download<float>(context, body.diffusion().pcg().rhs()), before);
}

}  // namespace
}  // namespace alabaster

// The light and the deferred correction of each cell, and the right-hand side they make.
#include "support/surface_passes.h"

namespace alabaster {
namespace {

using GpuDiffusionFacets = SurfacePasses;

TEST_F(GpuDiffusionFacets, FacetsAndSourceEqualTwin) {
  const std::vector<glm::vec4> gradient = random_gradients();
  const gpu::Image gradients = table(gradient), on_points = points();
  const gpu::Buffer cell_sources = results<float>(cut.size() * channels),
                    face_fluxes = results<float>(cut.size() * channels * 6),
                    facet_offsets = results<float>(cut.size() * channels);
  const Multigrid& multigrid = body.diffusion().multigrid();
  const std::vector<float> stencil = gpu::download<float>(context, body.diffusion().multigrid().finest().stencil);
  const std::vector<float> B = gpu::download<float>(context, body.diffusion().facet_conductances());
  const gpu::Image power_image = packed_image(context, n, channels, 1, "power in the cells");
  std::vector<float> power(volume.size() * channels);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (std::size_t i = 0; i < power.size(); ++i) power[i] = volume[i % volume.size()] > 0 ? uniform(engine) : 0;
  gpu::upload(context, power_image, power);
  const glm::vec3 per_power(0.5f, 2.f, 30.f);
  for (const auto& [corrected, in_cells] : {std::pair(false, false), {true, false}, {false, true}}) {
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
    commands.dispatch(passes.source[corrected][in_cells], multigrid.threads(0),
                      {{"bricks", multigrid.bricks().packed},
                       {"cut_index", domain.cut_index},
                       {"cut_cells", domain.cut_cells},
                       {"cell_sources", cell_sources},
                       {"face_fluxes", face_fluxes},
                       {"scales", scale_buffer},
                       {"volume_power", power_image},
                       {"rhs", rhs}},
                      SourcePush{n, static_cast<int>(cut.size()), per_power});
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
        b[at(cut[i].cell)] += B[c * cut.size() + i] * (q(i, c, true) - o) / scales[c].unit;
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
        if (in_cells) b[i] += double(per_power[c]) * power[c * b.size() + i] / scales[c].unit;
        source.add(got[c * b.size() + i], b[i]);
      }
      EXPECT_EQ(offset.value > 0, corrected);
      EXPECT_LE(offset.apart, 1e-5 * offset.value) << c;
      EXPECT_GT(source.value, 0);
      EXPECT_LT(source.apart, 1e-5 * source.value) << c << " corrected " << corrected;
    }
  }
}

}  // namespace
}  // namespace alabaster

#include "diffusion/near_surface.h"
#include "support/surface_passes.h"

namespace alabaster {
namespace {

class GpuDiffusionSurface : public SurfacePasses {
 protected:
  using SurfacePasses::SurfacePasses;
  void check_surface();
};

class GpuDiffusionSurfaceGrey : public GpuDiffusionSurface {
 protected:
  GpuDiffusionSurfaceGrey() : GpuDiffusionSurface(1, 1) {}
};

void GpuDiffusionSurface::check_surface() {
  const std::vector<glm::vec4> gradient = random_gradients();
  const gpu::Image gradients = table(gradient), on_points = points(), lines = table(2 * channels), lights = table(2);
  std::vector<gpu::Image> images;
  for (const char* name : {"phi up", "phi down", "gamma up", "gamma down"})
    images.push_back(gpu::image3d(context, n, VK_FORMAT_R32G32B32A32_SFLOAT, name));
  gpu::Commands commands(context);
  const NearSurface near = find_near_surface(context, domain);
  const gpu::Buffer near_cells = gpu::make_buffer(context, near.cells, "near cells"),
                    neighbours = gpu::make_buffer(context, near.neighbours, "neighbours");
  for (int k = 0; k < 4; ++k) commands.clear(images[k], k < 2 ? glm::vec4(0, 0, 0, 1) : glm::vec4(0));
  commands.dispatch(passes.carry, {cut.size(), channels, 1},
                    {{"cut_index", domain.cut_index},
                     {"cut_cells", domain.cut_cells},
                     {"gradients", gradients},
                     {"gamma_s", gamma_buffer},
                     {"query_gamma", query_buffer},
                     {"facets", body.diffusion().facet_medium()},
                     {"lines", lines},
                     {"side_lights", lights}},
                    push());
  const BrickList& bricks = body.diffusion().multigrid().bricks();
  commands.dispatch(passes.inner[channels == 3], {bricks.count * 8, 1, 1},
                    {{"bricks", bricks.packed},
                     {"scales", scale_buffer},
                     {"phi", body.diffusion().pcg().solution()},
                     {"phi_up", images[0]},
                     {"phi_down", images[1]}},
                    push());
  commands.dispatch(passes.surface[channels == 3], {near.cells.size(), 1, 1},
                    {{"cut_index", domain.cut_index},
                     {"cut_cells", domain.cut_cells},
                     {"scales", scale_buffer},
                     {"volume", domain.volume},
                     {"phi", body.diffusion().pcg().solution()},
                     {"near_cells", near_cells},
                     {"cut_neighbours", neighbours},
                     {"points", on_points},
                     {"lines", lines},
                     {"side_lights", lights},
                     {"phi_up", images[0]},
                     {"phi_down", images[1]},
                     {"gamma_up", images[2]},
                     {"gamma_down", images[3]}},
                    push());
  commands.submit();
  std::size_t kinds[4] = {0}, sheets = 0;  // whole, cut, taken from neighbours, far outside; with a slope a side
  Largest fluence_seen, gamma_seen;
  for (int side = 0; side < 2; ++side) {
    const std::vector<float> got = gpu::download<float>(context, images[side]),
                             got_gamma = gpu::download<float>(context, images[2 + side]);
    for_cells([&](glm::ivec3 cell) {
      for (int rgb = 0; rgb < 3; ++rgb) {
        const int c = std::min(rgb, channels - 1);
        const auto carried = [&](std::uint32_t i, glm::dvec3 point) {
          const GpuFacet& facet = cut[i].side[side];
          const glm::dvec4 g(gradient[c * cut.size() + i]);
          const glm::dvec3 away = point - glm::dvec3(cut[i].centre);
          if (glm::length(cut[i].facet.area_vector) > 0.5f * cut[i].facet.area || facet.area <= 0)
            return g.w + glm::dot(glm::dvec3(g), away);
          ++sheets;
          const glm::dvec3 normal = glm::normalize(glm::dvec3(facet.area_vector));
          const double across = glm::dot(normal, away), d = depth(i, side, c);
          const double boundary = dsbc_source(gamma_of(i, side, c), body.f_dt());
          const double sheet = (2 * A * g.w + d * boundary) / (2 * A + d);
          return g.w + glm::dot(glm::dvec3(g), away - across * normal) +
                 across * (sheet - g.w) / std::max(double(facet.distance), 0.05);
        };
        // Light of cells: of this side, and of the other as far as it faces the same way.
        struct Sums {
          double light = 0, area = 0;
          glm::dvec3 normal{0};
        };
        using Sides = std::array<Sums, 2>;
        const auto add = [&](Sides& sums, std::uint32_t i) {
          for (int which = 0; which < 2; ++which) {
            sums[which].light += cut[i].side[which].area * gamma_of(i, which, c) * query_share(i, which);
            sums[which].area += cut[i].side[which].area;
            sums[which].normal += glm::dvec3(cut[i].side[which].area_vector);
          }
        };
        const auto mean = [&](const Sides& sums) {
          const Sums &mine = sums[side], &other = sums[1 - side];
          const double lengths = glm::length(mine.normal) * glm::length(other.normal);
          const double alike = lengths > 1e-30 ? std::max(0.0, glm::dot(mine.normal, other.normal) / lengths) : 0;
          const double share = mine.area > 0 ? alike : 1, area = mine.area + share * other.area;
          return area > 0 ? (mine.light + share * other.light) / area : 0;
        };
        const std::uint32_t own = index(cell);
        double weights = 0, sum = 0;
        Sides around, here;
        if (own != 0) add(here, own);
        for (int k = 0; k < 27; ++k) {
          const glm::ivec3 d(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
          const std::uint32_t i = index(cell + d);
          if (i == 0) continue;
          const glm::dvec3 point = glm::dvec3(0.5) - glm::dvec3(d), apart = point - glm::dvec3(cut[i].centre);
          weights += cut[i].volume / glm::dot(apart, apart);
          sum += cut[i].volume / glm::dot(apart, apart) * carried(i, point);
          add(around, i);
        }
        double value = 0;
        int kind = 3;
        if (own == 0 && size(cell) > 0) {
          value = fluence(cell, c), kind = 0;
        } else if (own != 0 && size(cell) >= 0.05f) {
          value = carried(own, glm::dvec3(0.5)), kind = 1;
        } else if (weights > 0) {
          value = sum / weights, kind = 2;
        }
        ++kinds[kind];
        fluence_seen.add(got[4 * at(cell) + rgb], value);
        gamma_seen.add(got_gamma[4 * at(cell) + rgb], here[side].area > 0 ? mean(here) : mean(around));
      }
      fluence_seen.add(got[4 * at(cell) + 3], 1);
    });
  }
  for (std::size_t kind : kinds) EXPECT_GT(kind, 100u);
  EXPECT_GT(sheets, 10u);
  EXPECT_LT(fluence_seen.apart, 1e-5 * fluence_seen.value);
  EXPECT_LT(gamma_seen.apart, 1e-5 * gamma_seen.value);
}

TEST_F(GpuDiffusionSurface, SurfaceEqualsTwin) { check_surface(); }
TEST_F(GpuDiffusionSurfaceGrey, SurfaceEqualsTwin) { check_surface(); }

}  // namespace
}  // namespace alabaster

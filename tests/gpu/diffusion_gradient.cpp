#include "support/surface_passes.h"

namespace alabaster {
namespace {

using GpuDiffusionGradient = SurfacePasses;

TEST_F(GpuDiffusionGradient, GradientEqualsTwin) {
  const gpu::Image gradients = table(channels), on_points = points();
  gpu::Commands commands(context);
  commands.dispatch(passes.gradient, {cut.size(), channels, 1},
                    {{"cut_index", domain.cut_index},
                     {"cut_cells", domain.cut_cells},
                     {"conductances", body.diffusion().facet_conductances()},
                     {"gamma_s", gamma_buffer},
                     {"facets", body.diffusion().facet_medium()},
                     {"scales", scale_buffer},
                     {"volume", domain.volume},
                     {"phi", body.diffusion().pcg().solution()},
                     {"points", on_points},
                     {"gradients", gradients}},
                    push());
  commands.submit();
  const std::vector<glm::vec4> got = entries(gradients);
  std::size_t slivers = 0;
  for (int c = 0; c < channels; ++c) {
    Largest slope, value;
    for (std::size_t i = 1; i < cut.size(); ++i) {
      const glm::ivec3 cell = cut[i].cell;
      slivers += cut[i].volume < 0.05f;
      glm::dmat3 matrix(0);
      glm::dvec3 right(0);
      const auto equation = [&](glm::dvec3 d, double weight, double difference) {
        matrix += weight / glm::dot(d, d) * glm::outerProduct(d, d);
        right += weight / glm::dot(d, d) * difference * d;
      };
      for (int axis = 0; axis < 3; ++axis)
        for (int side : {-1, 1}) {
          glm::ivec3 other = cell;
          other[axis] += side;
          if (size(other) <= 0) continue;
          equation(glm::dvec3(other - cell) + centre(other) - centre(cell), std::min(1.0, size(other) / 0.05),
                   fluence(other, c) - fluence(cell, c));
        }
      const glm::dvec3 area(cut[i].facet.area_vector);
      if (glm::length(area) > 0.5 * cut[i].facet.area)
        equation(glm::dvec3(cut[i].facet.centre) - centre(cell) + 2 * A * facets[i].kappa[c] / h * glm::normalize(area),
                 1, q(i, c) - fluence(cell, c));
      const double trace = matrix[0][0] + matrix[1][1] + matrix[2][2];
      const glm::dvec3 g = trace > 0 ? glm::inverse(matrix + glm::dmat3(1e-4 * trace)) * right : glm::dvec3(0);
      const glm::vec4 mine = got[c * cut.size() + i];
      for (int axis = 0; axis < 3; ++axis) slope.add(mine[axis], g[axis]);
      value.add(mine.w, fluence(cell, c));
    }
    EXPECT_GT(slope.value, 0);
    EXPECT_LT(slope.apart, 1e-3 * slope.value) << c;  // 1e-4 of the trace conditions the worst of the matrices
    EXPECT_LT(value.apart, 1e-6 * value.value) << c;
  }
  EXPECT_GT(slivers, 10u);
}

TEST_F(GpuDiffusionGradient, PointsAreTheDomains) {
  const std::vector<glm::vec4> got = entries(points());
  int bent = 0;
  for (std::size_t i = 0; i < cut.size(); ++i) {
    EXPECT_EQ(got[i], glm::vec4(cut[i].centre, cut[i].volume)) << i;
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(got[(1 + axis) * cut.size() + i], glm::vec4(cut[i].low_face_centre[axis], cut[i].cell[axis])) << i;
    const GpuFacet& facet = cut[i].facet;
    const float up = cut[i].side[0].area, all = up + cut[i].side[1].area;
    const glm::vec4 beside = got[DIFFUSION_POINT_BESIDE * cut.size() + i],
                    normal = got[DIFFUSION_POINT_NORMAL * cut.size() + i];
    EXPECT_NEAR(beside.w, all > 0 ? up / all : 0, 1e-6) << i;
    if (glm::length(facet.area_vector) <= 0.5f * facet.area) {
      ++bent;
      EXPECT_EQ(glm::vec3(beside), glm::vec3(0)) << i;
      EXPECT_EQ(glm::vec3(normal), glm::vec3(0)) << i;
    } else {
      EXPECT_LT(glm::length(glm::vec3(normal) - glm::normalize(facet.area_vector)), 1e-5f) << i;
      EXPECT_LT(std::abs(glm::dot(glm::vec3(beside), glm::vec3(normal))), 1e-5f) << i;
      EXPECT_LT(glm::length(cut[i].centre + glm::vec3(beside) + normal.w * glm::vec3(normal) - facet.centre), 1e-5f)
          << i;
    }
  }
  EXPECT_GT(bent, 1);  // entry 0 has no facet
}

}  // namespace
}  // namespace alabaster

#include <gtest/gtest.h>

#include "scene/scene.h"
#include "scene/shapes.h"

namespace alabaster {
namespace {

Grid ramp(int channels) {
  Grid grid{{4, 3, 2}, channels, {}};
  for (int z = 0; z < 2; ++z)
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 4; ++x)
        for (int c = 0; c < channels; ++c) grid.values.push_back(float(x + 10 * y + 100 * z + 1000 * c));
  return grid;
}

TEST(Grid, CellsInOrderAndClamped) {
  Grid grid = ramp(3);
  EXPECT_EQ(grid.at({2, 1, 1}), glm::dvec3(112, 1112, 2112));
  EXPECT_EQ(grid.at({-5, 9, 1}), glm::dvec3(120, 1120, 2120));
  EXPECT_EQ(ramp(1).at({3, 0, 0}), glm::dvec3(3));
}

TEST(Grid, TrilinearReproducesLinearBetweenCentresAndClampsOutside) {
  Grid grid = ramp(1);
  glm::dvec3 cell(1.3, 0.6, 0.25);  // in cell-centre coordinates
  glm::dvec3 unit = (cell + 0.5) / glm::dvec3(grid.size);
  EXPECT_NEAR(grid.sample(unit).x, 1.3 + 6 + 25, 1e-12);
  EXPECT_NEAR(grid.sample({-1e30, 0.5, 1e30}).x, 110, 1e-12);
  grid.trilinear = false;
  EXPECT_EQ(grid.sample({0.49, 0.34, 0.51}).x, 111);
  EXPECT_EQ(grid.sample({1.0, 1.0, 1.0}).x, 123);
}

TEST(Medium, GridsAreInterpolatedApartAndBoundedByTheMajorant) {
  Medium medium;
  medium.sigma_t = std::make_shared<Grid>(Grid{{2, 1, 1}, 1, {10, 30}});
  medium.albedo = std::make_shared<Grid>(Grid{{2, 1, 1}, 3, {0, 0, 0, 1, 0.5f, 0}});
  medium.scale = 2;
  medium.world_to_box = glm::inverse(translation({1, 0, 0}) * scaling({4, 1, 1}));
  Coefficients middle = medium.at({3, 0.5, 0.5});
  EXPECT_NEAR(middle.sigma_s.r, 20, 1e-12);  // 2 * 20 * 0.5
  EXPECT_NEAR(middle.sigma_s.g, 10, 1e-12);
  EXPECT_NEAR(middle.sigma_a.b, 40, 1e-12);
  EXPECT_EQ(medium.majorant(), glm::dvec3(60));
}

TEST(Bounds, OnlyOfUsedVertices) {
  Mesh mesh = box({2, 2, 2});
  mesh.positions.push_back(glm::vec3(100));
  EXPECT_EQ(bounds_of(mesh).size(), glm::vec3(2));
}

}  // namespace
}  // namespace alabaster

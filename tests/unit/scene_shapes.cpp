#include <gtest/gtest.h>

#include <map>

#include "scene/shapes.h"

namespace alabaster {
namespace {

constexpr double pi = 3.141592653589793;

/// Every directed edge occurs once and its opposite once: closed, manifold along edges, consistently wound.
void expect_closed(const Mesh& mesh) {
  std::map<std::pair<unsigned, unsigned>, int> edges;
  for (glm::uvec3 t : mesh.triangles)
    for (int i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  for (auto [edge, count] : edges) {
    ASSERT_EQ(count, 1);
    ASSERT_TRUE(edges.contains({edge.second, edge.first}));
  }
  EXPECT_LT(glm::length(area_vector(mesh)), 1e-6 * area(mesh));
}

TEST(Shapes, SphereVolumesAndAreasConverge) {
  double last = 1;
  for (int level = 2; level <= 5; ++level) {
    Mesh mesh = icosphere(level, 2);
    expect_closed(mesh);
    double error = 1 - signed_volume(mesh) / (4.0 / 3 * pi * 8);
    EXPECT_GT(error, 0);
    EXPECT_LT(error, 0.3 * last);
    last = error;
  }
  Mesh sphere = uv_sphere(64, 128);
  expect_closed(sphere);
  EXPECT_NEAR(signed_volume(sphere), 4.0 / 3 * pi, 0.01);
  EXPECT_NEAR(area(sphere), 4 * pi, 0.02);
}

TEST(Shapes, OthersAreClosedAndOfTheRightVolume) {
  Mesh shape = box({1, 2, 3}, 4);
  expect_closed(shape);
  EXPECT_NEAR(signed_volume(shape), 6, 1e-5);
  EXPECT_NEAR(area(shape), 22, 1e-5);
  shape = torus(2, 0.5f, 96, 48);
  expect_closed(shape);
  EXPECT_NEAR(signed_volume(shape) / (2 * pi * pi * 2 * 0.25), 1, 0.005);
  shape = cylinder(0.5f, 3, 64, 4);
  expect_closed(shape);
  EXPECT_NEAR(signed_volume(shape) / (pi * 0.25 * 3), 1, 0.002);
  shape = ellipsoid(4, {1, 2, 3});
  expect_closed(shape);
  EXPECT_NEAR(signed_volume(shape) / (4.0 / 3 * pi * 6), 1, 0.01);
}

TEST(Shapes, MirroringKeepsOutsideOutside) {
  Mesh mesh = transformed(icosphere(2), translation({5, 0, 0}) * scaling({-1, 1, 1}));
  EXPECT_GT(signed_volume(mesh), 0);
  EXPECT_NEAR(bounds_of(mesh).centre().x, 5, 1e-6);
  EXPECT_LT(signed_volume(flipped(mesh)), 0);
}

TEST(Shapes, QuadFacesUp) { EXPECT_NEAR(area_vector(quad(2, 3)).y, 6, 1e-6); }

TEST(Shapes, LookAtLooksAlongMinusZ) {
  glm::mat4 frame = look_at({0, 1, 4}, {0, 1, 0});
  EXPECT_NEAR(glm::length(glm::vec3(frame[3]) - glm::vec3(0, 1, 4)), 0, 1e-6);
  EXPECT_NEAR(frame[2].z, 1, 1e-6);
}

}  // namespace
}  // namespace alabaster

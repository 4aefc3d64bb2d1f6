// Procedural solids in scene files, what they are at a point, and the depth below a surface that skin goes by.
#include <gtest/gtest.h>

#include <random>

#include "reference/media.h"
#include "scene/depth.h"
#include "scene/error.h"
#include "scene/files.h"
#include "scene/inside.h"
#include "scene/load.h"
#include "scene/presets.h"
#include "scene/procedural.h"
#include "scene/shapes.h"
#include "scene/write_gltf.h"
#include "support/hostile.h"
#include "support/temp_folder.h"

namespace alabaster {
namespace {

using nlohmann::json;
using test::Glb;
using test::TempFolder;

Scene with_medium(const json& medium, const json& node = json::object()) {
  TempFolder folder;
  write_gltf(test::good_scene(), folder / "scene.glb");
  Glb glb = Glb::read(folder / "scene.glb");
  glb.root["materials"][test::marble]["extras"]["medium"] = medium;
  glb.root["nodes"][test::marble].update(node);
  write_file(folder / "scene.glb", glb.bytes());
  return load_scene(folder / "scene.glb");
}

/// The box of good_scene(), 0.04 m on a side from (0.08, 0, -0.02).
const Medium& medium_of(const Scene& scene) { return scene.objects[test::marble].medium; }

TEST(ProceduralSolids, AreMixturesBelowTheirMajorant) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (std::uint32_t kind = 0; kind < solid_kinds; ++kind) {
    SCOPED_TRACE(solid_names[kind]);
    const Scene scene = with_medium({{"type", "procedural"}, {"name", solid_names[kind]}});
    const Medium& medium = medium_of(scene);
    ASSERT_TRUE(medium.heterogeneous());
    EXPECT_FALSE(medium.gridded());
    EXPECT_GT(medium.feature_size(), 1e-5);
    EXPECT_LT(medium.feature_size(), 0.01);
    const FlatMedium flat(medium);
    const glm::dvec3 most = medium.majorant();
    glm::dvec3 least_seen(INFINITY), most_seen(0);
    for (int i = 0; i < 3000; ++i) {
      const glm::dvec3 p = glm::dvec3(0.08, 0, -0.02) + 0.04 * glm::dvec3(unit(random), unit(random), unit(random));
      const Coefficients c = medium.at(p);
      const glm::dvec3 sigma_t = c.sigma_s + c.sigma_a;
      ASSERT_TRUE(glm::all(glm::lessThanEqual(sigma_t, most * (1 + 1e-6))));
      least_seen = glm::min(least_seen, sigma_t), most_seen = glm::max(most_seen, sigma_t);
      if (kind == solid_checker) continue;  // a float may lie in the next cube
      const Optics f = flat.at(p);          // the path tracer's, in single precision
      ASSERT_LT(glm::distance(glm::dvec3(f.sigma_t), sigma_t), 2e-3 * glm::length(sigma_t));
      ASSERT_LT(glm::distance(glm::dvec3(f.sigma_s), c.sigma_s), 2e-3 * glm::length(sigma_t));
    }
    EXPECT_GT(most_seen.b, 1.02 * least_seen.b);
    EXPECT_GT(most_seen.b, 0.7 * most.b);
  }
}

TEST(ProceduralSolids, StandWhereTheSceneSays) {
  const json white = {{"sigma_s", 1000}, {"sigma_a", 1}}, black = {{"sigma_s", 500}, {"sigma_a", {10, 20, 30}}};
  const json checker = {{"type", "procedural"},   {"name", "checker"}, {"g", 0.25},
                        {"origin", {0.08, 0, 0}}, {"size", 0.01},      {"parts", {white, black}}};
  const Scene scene = with_medium(checker);
  EXPECT_EQ(medium_of(scene).g, 0.25);
  for (int i = 0; i < 4; ++i)
    for (int k = -2; k < 2; ++k) {
      const Coefficients c = medium_of(scene).at({0.085 + 0.01 * i, 0.005, 0.005 + 0.01 * k});
      EXPECT_EQ(c.sigma_s.r, (i + k) % 2 ? 500 : 1000) << i << " " << k;
      EXPECT_EQ(c.sigma_a.g, (i + k) % 2 ? 20 : 1);
    }
  // A node carries its pattern along: twice as large, and moved.
  const Scene moved = with_medium(checker, {{"scale", {2, 2, 2}}, {"translation", {0, 0.1, 0}}});
  const glm::dvec3 p(0.0913, 0.0137, 0.0042);
  EXPECT_EQ(medium_of(moved).at(2.0 * p + glm::dvec3(0, 0.1, 0)).sigma_s.r, medium_of(scene).at(p).sigma_s.r);
}

TEST(ProceduralSolids, WithoutAPlaceFitTheirObject) {
  const Medium a = medium_of(with_medium({{"type", "procedural"}, {"name", "marble"}}));
  const Medium b = medium_of(with_medium(
      {{"type", "procedural"}, {"name", "marble"}, {"origin", {0.08, 0, -0.02}}, {"size", 0.04}, {"seed", 0}}));
  const Medium c = medium_of(with_medium({{"type", "procedural"}, {"name", "marble"}, {"seed", 1}}));
  const glm::dvec3 p(0.0943, 0.0137, 0.0042);
  EXPECT_NEAR(a.at(p).sigma_a.r, b.at(p).sigma_a.r, 1e-3 * a.at(p).sigma_a.r);
  EXPECT_GT(std::abs(a.at(p).sigma_a.r - c.at(p).sigma_a.r), 1e-3 * a.at(p).sigma_a.r);
}

TEST(ProceduralSolids, SkinIsLayeredByDepth) {
  const json layers = {{{"preset", "skin1"}}, {{"preset", "skin2"}}, {{"sigma_s", 1200}, {"sigma_a", 3}}};
  const Scene scene = with_medium(
      {{"type", "procedural"}, {"name", "skin"}, {"depths", {0.001, 0.004}}, {"sharpness", 5}, {"parts", layers}});
  const auto at = [&](double depth) { return medium_of(scene).at({0.1, 0.04 - depth, 0.001}).sigma_s.g; };
  EXPECT_NEAR(at(1e-5), preset("skin1")->coefficients.sigma_s.g, 1e-3);
  EXPECT_NEAR(at(0.0009), preset("skin1")->coefficients.sigma_s.g, 1e-3);
  EXPECT_NEAR(at(0.0011), preset("skin2")->coefficients.sigma_s.g, 1e-3);
  EXPECT_NEAR(at(0.0037), preset("skin2")->coefficients.sigma_s.g, 1e-3);
  EXPECT_NEAR(at(0.0043), 1200, 1e-3);
  EXPECT_NEAR(at(0.02), 1200, 1e-3);
}

TEST(ProceduralSolids, AreReadBackAsWritten) {
  TempFolder folder;
  for (const char* name : {"agate", "jade"}) {
    const Scene written = with_medium({{"type", "procedural"}, {"name", name}, {"seed", 7}, {"turbulence", 0.5}});
    write_gltf(written, folder / "again.glb");
    const Scene read = load_scene(folder / "again.glb");
    for (double x : {0.085, 0.0953, 0.111}) {
      const glm::dvec3 p(x, 0.0137, 0.0042);
      EXPECT_NEAR(medium_of(read).at(p).sigma_a.r, medium_of(written).at(p).sigma_a.r, 1e-9) << name;
    }
  }
}

TEST(ProceduralSolids, AreRefusedWithTheField) {
  const auto expect_error = [](json change, const char* field, const char* name = "marble") {
    json medium = {{"type", "procedural"}, {"name", name}};
    medium.update(change);
    try {
      with_medium(medium);
      FAIL() << field;
    } catch (const UserError& error) {
      EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
    }
  };
  expect_error({{"name", "cheese"}}, "name");
  expect_error({{"seed", 1.5}}, "seed");
  expect_error({{"turbulence", -1}}, "turbulence");
  expect_error({{"sharpness", 0}}, "sharpness");
  expect_error({{"size", 0}}, "size");
  expect_error({{"origin", {0, 1}}}, "origin");
  expect_error({{"parts", 3}}, "parts");
  expect_error({{"parts", {{{"sigma_s", 1}, {"sigma_a", 1}}}}}, "list of 2");
  expect_error({{"parts", {{{"sigma_s", 1}, {"sigma_a", -1}}, {{"preset", "apple"}}}}}, "parts[0].sigma_a");
  expect_error({{"parts", {{{"preset", "apple"}}, {{"preset", "pear"}}}}}, "parts[1].preset");
  expect_error({{"depths", {0.002, 0.001}}}, "depths", "skin");
  expect_error({{"depths", {0.002}}}, "depths", "skin");
  expect_error({{"sharpness", 0.1}}, "sharpness", "skin");
}

TEST(DepthGrid, IsTheSignedDistanceToTheSurface) {
  const Mesh ball = transformed(icosphere(4, 0.05f), translation({0.1, 0.2, 0.3}));
  const DepthGrid depth = measure_depth(ball, 0.004);
  const auto at = [&](glm::dvec3 p) { return depth.grid->sample(glm::dvec3(depth.world_to_box * glm::dvec4(p, 1))).x; };
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 500; ++i) {
    const glm::dvec3 way = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    for (double d : {-5e-4, 0.0, 1e-4, 1e-3, 2e-3, 4e-3})
      EXPECT_NEAR(at(glm::dvec3(0.1, 0.2, 0.3) + (0.05 - d) * way), d, 9e-5);  // the facets' sag
  }
  EXPECT_GE(at({0.1, 0.2, 0.3}), 0.004);
}

TEST(DepthGrid, KnowsInsideFromOutsideAtEdgesAndInHoles) {
  // Sharp edges, and a torus whose rows of points go in and out twice.
  for (const Mesh& mesh : {transformed(box({0.1f, 0.02f, 0.05f}), rotation({1, 2, 3}, 30)),
                           transformed(torus(0.05f, 0.02f, 32, 16), rotation({1, 0, 1}, 40))}) {
    const DepthGrid depth = measure_depth(mesh, 0.001);
    const glm::dmat4 back = glm::inverse(depth.world_to_box);
    const Grid& grid = *depth.grid;
    int checked = 0;
    for (int z = 0; z < grid.size.z; z += 7)
      for (int y = 0; y < grid.size.y; y += 7)
        for (int x = 0; x < grid.size.x; x += 3) {
          const double d = grid.at({x, y, z}).x;
          if (std::abs(d) < 1e-4) continue;
          const glm::dvec3 p(back * glm::dvec4((glm::dvec3(x, y, z) + 0.5) / glm::dvec3(grid.size), 1));
          ASSERT_EQ(d > 0, inside(mesh, p)) << x << " " << y << " " << z << " " << d;
          ++checked;
        }
    EXPECT_GT(checked, 500);
  }
}

}  // namespace
}  // namespace alabaster

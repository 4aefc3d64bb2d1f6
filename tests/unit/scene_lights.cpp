// KHR_lights_punctual in and out, the extent that lights get, and what is refused.
#include <gtest/gtest.h>

#include "scene/error.h"
#include "scene/files.h"
#include "scene/load.h"
#include "scene/write_gltf.h"
#include "support/hostile.h"
#include "support/temp_folder.h"

namespace alabaster {
namespace {

using nlohmann::json;
using test::Glb;
using test::TempFolder;
using Kind = PunctualLight::Kind;

/// good_scene() without its lamp, changed as JSON, read again.
template <typename Change>
Scene reloaded(Change change) {
  TempFolder folder;
  Scene scene = test::good_scene();
  scene.objects.pop_back();
  write_gltf(scene, folder / "scene.glb");
  Glb glb = Glb::read(folder / "scene.glb");
  change(glb);
  write_file(folder / "scene.glb", glb.bytes());
  return load_scene(folder / "scene.glb");
}

/// The scene lit by one light in a node of its own.
Scene lit_by(const json& light, json node = {{"translation", {0, 0.5, 0}}}) {
  return reloaded([&](Glb& glb) {
    glb.root["extensions"]["KHR_lights_punctual"]["lights"] = json::array({light});
    node["name"] = "sun";
    node["extensions"]["KHR_lights_punctual"]["light"] = 0;
    glb.root["nodes"].push_back(node);
    glb.root["scenes"][0]["nodes"].push_back(glb.root["nodes"].size() - 1);
  });
}

TEST(PunctualLights, AreReadWhereTheirNodesStand) {
  const double half = std::sqrt(0.5);
  const json turned = {{"translation", {0.3, 0.5, 0}}, {"rotation", {-half, 0, 0, half}}, {"scale", {3, 3, 3}}};
  const json cone = {{"type", "spot"},
                     {"color", {1, 0.5, 0.25}},
                     {"intensity", 8},
                     {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.4}}}};
  const Scene scene = lit_by(cone, turned);
  ASSERT_EQ(scene.lights.size(), 1u);
  const PunctualLight& light = scene.lights[0];
  EXPECT_EQ(light.name, "sun");
  EXPECT_EQ(light.kind, Kind::spot);
  EXPECT_EQ(light.intensity, glm::vec3(8, 4, 2));
  EXPECT_EQ(light.position, glm::vec3(0.3f, 0.5f, 0));
  EXPECT_LT(glm::distance(light.direction, glm::vec3(0, -1, 0)), 1e-6f);  // -z turned by -90 degrees about x
  EXPECT_EQ(light.inner_cone, 0.2);
  EXPECT_EQ(light.outer_cone, 0.4);
  EXPECT_GT(light.radius, 0.005);  // 0.02 of half a metre
  EXPECT_LT(light.radius, 0.015);
}

TEST(PunctualLights, HaveTheDefaultsOfTheExtension) {
  const PunctualLight point = lit_by({{"type", "point"}}).lights.at(0);
  EXPECT_EQ(point.intensity, glm::vec3(1));
  const PunctualLight far = lit_by({{"type", "directional"}, {"extras", {{"angular_radius", 0.005}}}}).lights.at(0);
  EXPECT_EQ(far.radius, 0.005);
  EXPECT_EQ(far.direction, glm::vec3(0, 0, -1));
  EXPECT_EQ(lit_by({{"type", "point"}, {"extras", {{"radius", 0}}}}).lights.at(0).radius, 0);
  const PunctualLight spot = lit_by({{"type", "spot"}, {"spot", json::object()}}).lights.at(0);
  EXPECT_EQ(spot.inner_cone, 0);
  EXPECT_NEAR(spot.outer_cone, 0.785398163, 1e-9);
  const Scene ranged = lit_by({{"type", "point"}, {"range", 3}});
  ASSERT_EQ(ranged.warnings.size(), 1u);
  EXPECT_NE(ranged.warnings[0].find("range"), std::string::npos);
}

TEST(PunctualLights, NearSurfacesAreSmaller) {
  const PunctualLight near = lit_by({{"type", "point"}}, {{"translation", {0, 0.101, 0}}}).lights.at(0);
  EXPECT_NEAR(near.radius, 0.00025, 2e-5);  // a quarter of the way to the ball, whose top is at 0.1
}

TEST(PunctualLights, AreReadBackAsWritten) {
  TempFolder folder;
  Scene written = test::good_scene();
  written.lights = {{"point", Kind::point, {1, 2, 3}, {0.5f, 0.5f, 0.5f}, {0, 0, -1}, 0, M_PI / 4, 0.01},
                    {"spot", Kind::spot, {9, 2, 3}, {-0.5f, 0.5f, 0.5f}, {0.6f, -0.8f, 0}, 0.1, 0.3, 0.02},
                    {"sun", Kind::directional, {1, 1, 1}, {0, 0, 0}, {0, -1, 0}, 0, M_PI / 4, 0.00465}};
  write_gltf(written, folder / "scene.glb");
  const Scene read = load_scene(folder / "scene.glb");
  ASSERT_EQ(read.lights.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    const PunctualLight &a = written.lights[i], &b = read.lights[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_LT(glm::distance(a.intensity, b.intensity), 1e-6f * glm::length(a.intensity));
    EXPECT_EQ(a.position, b.position);
    EXPECT_LT(glm::distance(a.direction, b.direction), 1e-6f) << a.name;
    EXPECT_EQ(a.inner_cone, b.inner_cone);
    EXPECT_EQ(a.outer_cone, b.outer_cone);
    EXPECT_EQ(a.radius, b.radius);
  }
}

TEST(PunctualLights, AreRefusedWithTheField) {
  const auto expect_error = [](const json& light, const char* field, json node = {{"translation", {0, 0.5, 0}}}) {
    try {
      lit_by(light, node);
      FAIL() << field;
    } catch (const UserError& error) {
      EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("sun"), std::string::npos) << error.what();
    }
  };
  expect_error({{"type", "laser"}}, "type");
  expect_error({{"type", "point"}, {"intensity", -1}}, "intensity");
  expect_error({{"type", "point"}, {"intensity", "bright"}}, "intensity");
  expect_error({{"type", "point"}, {"color", {1, 1}}}, "color");
  EXPECT_THROW(lit_by({{"type", "spot"}}), UserError);  // the extension wants `spot` there
  expect_error({{"type", "spot"}, {"spot", {{"outerConeAngle", 2}}}}, "outerConeAngle");
  expect_error({{"type", "spot"}, {"spot", {{"innerConeAngle", 0.9}}}}, "innerConeAngle");
  expect_error({{"type", "point"}, {"extras", {{"radius", -1}}}}, "radius");
  expect_error({{"type", "point"}, {"extras", {{"radius", 0.45}}}}, "extras.radius");  // reaches into the ball
  expect_error({{"type", "directional"}, {"extras", {{"angular_radius", 1}}}}, "angular_radius");
  expect_error({{"type", "point"}}, "inside the translucent object 'ball'", {{"translation", {0, 0.05, 0}}});
  expect_error({{"type", "directional"}}, "scale", {{"translation", {0, 0.5, 0}}, {"scale", {0, 0, 0}}});
}

TEST(PunctualLights, ALightThatIsNotThereIsNamed) {
  EXPECT_THROW(reloaded([](Glb& glb) { glb.root["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 3; }),
               UserError);
}

}  // namespace
}  // namespace alabaster

#include <gtest/gtest.h>

#include "scene/demo_scenes.h"
#include "scene/error.h"
#include "scene/files.h"
#include "scene/inside.h"
#include "scene/load.h"
#include "scene/marble.h"
#include "scene/off.h"
#include "scene/procedural.h"
#include "scene/shapes.h"
#include "scene/write_gltf.h"
#include "support/temp_folder.h"

namespace alabaster {
namespace {

// Only scenes of generated shapes: the scanned meshes are not part of the tests.

TEST(DemoScenes, StandOnTheGroundInFrontOfTheCameraAndLoad) {
  test::TempFolder folder;
  for (const char* name :
       {"sphere-marble", "torus-wax", "box-potato", "plate-leaf", "sphere-furnace", "torus-furnace"}) {
    Scene scene = demo_scene(name, "nowhere");
    EXPECT_TRUE(scene.warnings.empty());
    Bounds bounds = bounds_of(scene.objects[0].mesh);
    EXPECT_NEAR(bounds.low.y, 0, 1e-6);
    EXPECT_NEAR(bounds.high.y, 0.1, 1e-6);
    glm::mat4 to_camera = glm::inverse(scene.cameras[0].to_world);
    for (glm::vec3 p : scene.objects[0].mesh.positions) {
      glm::vec3 seen(to_camera * glm::vec4(p, 1));
      ASSERT_LT(std::abs(seen.y / seen.z), std::tan(0.5f * scene.cameras[0].y_fov));
      ASSERT_LT(seen.z, 0);
    }
    for (const Object& object : scene.objects) {
      if (object.role != Role::emissive) continue;
      glm::dvec3 towards = glm::dvec3(bounds.centre() - bounds_of(object.mesh).centre());
      EXPECT_GT(glm::dot(area_vector(object.mesh), towards), 0.99 * area(object.mesh) * glm::length(towards))
          << object.name;
    }
    write_gltf(scene, folder / "scene.glb");
    EXPECT_EQ(load_scene(folder / "scene.glb").objects.size(), scene.objects.size());
  }
}

TEST(DemoScenes, StudyNamesSayTheMedium) {
  Object ball = demo_scene("sphere-50mfp-0.99-1.3", "nowhere").objects[0];
  EXPECT_NEAR(ball.medium.homogeneous.sigma_s.r, 495, 1e-9);
  EXPECT_NEAR(ball.medium.homogeneous.sigma_a.r, 5, 1e-9);
  EXPECT_EQ(ball.eta, 1.3);
  for (const char* name :
       {"sphere-50mfp-0.99", "sphere-0mfp-0.99-1.3", "sphere-5mfp-1.99-1.3", "cow-5mfp-0.9-1", "sphere", ""})
    EXPECT_THROW(demo_scene(name, "nowhere"), UserError) << name;
}

TEST(DemoScenes, StudiesOfMaterialsMeasureThemInMeanFreePaths) {
  const glm::vec3 sigma_t(500);
  const Object plain = demo_scene("torus-homogeneous-50mfp-1.3", "nowhere").objects[0];
  EXPECT_EQ(glm::vec3(plain.medium.homogeneous.sigma_s + plain.medium.homogeneous.sigma_a), sigma_t);
  for (const char* material : {"marble", "checker"}) {
    const Scene scene = demo_scene(std::string("torus-") + material + "-50mfp-1.3", "nowhere");
    const ProceduralSolid& solid = *scene.objects[0].medium.solid;
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(solid.parts[0].sigma_s[c] + solid.parts[0].sigma_a[c], sigma_t[c], 1e-3);
      EXPECT_LT(solid.parts[1].sigma_s[c] + solid.parts[1].sigma_a[c], sigma_t[c]);
      for (const SolidPart& part : solid.parts)
        EXPECT_GE(part.sigma_s[c], 0.9499 * (part.sigma_s[c] + part.sigma_a[c]));
    }
    EXPECT_EQ(scene.objects.size(), 3u) << "the object and two lamps, no ground";
  }
  const auto lamp_of = [](const std::string& name) { return bounds_of(demo_scene(name, "nowhere").objects[1].mesh); };
  EXPECT_LT(lamp_of("torus-marble-50mfp-1.3-back").high.z, 0);
  EXPECT_GT(lamp_of("plate-marble-50mfp-1.3-front").low.z, 0);
  EXPECT_LT(lamp_of("plate-marble-50mfp-1.3").high.z, 0);
  EXPECT_EQ(demo_scene("torus-marble-50mfp-1.3-punctual", "nowhere").lights.size(), 3u);
  for (const char* name : {"torus-marble-50mfp-1.3-back", "plate-marble-50mfp-1.3", "plate-leaf"})
    EXPECT_TRUE(lit_from_behind(name)) << name;
  for (const char* name : {"plate-marble-50mfp-1.3-front", "torus-marble-50mfp-1.3", "torus-wax", "cow"})
    EXPECT_FALSE(lit_from_behind(name)) << name;
  for (const char* name :
       {"torus-gold-50mfp-1.3", "torus-marble-0mfp-1.3", "torus-marble-50mfp", "torus-marble-50mfp-1.3-below"})
    EXPECT_THROW(demo_scene(name, "nowhere"), UserError) << name;
}

TEST(Marble, VeinsAreThereAndMostIsWhite) {
  Bounds bounds;
  bounds.add(glm::vec3(-1));
  bounds.add(glm::vec3(1));
  Medium marble = veined_marble(bounds, 32);
  double least = 1, mean = 0;
  const std::vector<float>& albedo = marble.albedo->values;
  for (std::size_t i = 0; i < albedo.size(); i += 3) {
    EXPECT_GT(albedo[i], 0.9);
    EXPECT_LT(albedo[i], 1);
    least = std::min(least, double(albedo[i]));
    mean += 3.0 * albedo[i] / double(albedo.size());
  }
  EXPECT_LT(1 - mean, 0.3 * (1 - least));
  EXPECT_NEAR(marble.at({0, 0, 0}).sigma_s.g, marble.majorant().g, 0.5 * marble.majorant().g);
}

TEST(Off, PolygonsCommentsAndErrors) {
  test::TempFolder folder;
  write_file(
      folder / "a.off",
      "OFF # a square and a triangle\n5 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n# apex\n0 0 1\n4 0 1 2 3\n3 0 1 4 255 0 0\n");
  Mesh mesh = read_off(folder / "a.off");
  ASSERT_EQ(mesh.triangles.size(), 3u);
  EXPECT_EQ(mesh.triangles[1], glm::uvec3(0, 2, 3));
  EXPECT_EQ(mesh.triangles[2], glm::uvec3(0, 1, 4));
  for (const char* bad : {"", "OFF 3 1 0\n0 0 0\n1 0 0\n", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", "PLY",
                          "OFF 9999999 1 0\n", "OFF 1 0 0\nnan 0 0\n"}) {
    write_file(folder / "bad.off", bad);
    EXPECT_THROW(read_off(folder / "bad.off"), UserError) << bad;
  }
}

}  // namespace
}  // namespace alabaster

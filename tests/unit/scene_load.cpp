#include <gtest/gtest.h>

#include "scene/error.h"
#include "scene/files.h"
#include "scene/load.h"
#include "scene/shapes.h"
#include "scene/write_gltf.h"
#include "support/temp_folder.h"

namespace alabaster {
namespace {

using test::TempFolder;

Object object(const std::string& name, Role role, Mesh mesh) {
  Object result;
  result.name = name;
  result.role = role;
  result.mesh = std::move(mesh);
  return result;
}

Scene small_scene() {
  Scene scene;
  Object ball = object("ball", Role::translucent, transformed(icosphere(2, 0.5f), translation({0, 1, 0})));
  ball.eta = 1.3;
  ball.medium.homogeneous = {{1000, 2000, 3000}, {1, 2, 3}};
  ball.medium.g = 0.5;
  Object marble = object("marble", Role::translucent, box({1, 1, 1}));
  marble.eta = 1;
  marble.medium.sigma_t = std::make_shared<Grid>(Grid{{2, 3, 4}, 1, std::vector<float>(24, 5)});
  marble.medium.albedo = std::make_shared<Grid>(Grid{{1, 1, 2}, 3, {0, 0.5f, 1, 1, 0.5f, 0}});
  marble.medium.scale = 3;
  marble.medium.world_to_box = glm::inverse(translation({-0.5, -0.5, -0.5}));
  Object ground = object("ground", Role::opaque, quad(4, 4));
  ground.albedo = {0.1f, 0.2f, 0.3f};
  Object lamp =
      object("lamp", Role::emissive, transformed(quad(1, 2), translation({0, 5, 0}) * rotation({1, 0, 0}, 180)));
  lamp.radiance = {10, 20, 5};
  lamp.two_sided = true;
  scene.objects = {ball, marble, ground, lamp};
  scene.cameras = {{"front", look_at({0, 1, 5}, {0, 1, 0}), 0.6f}, {"side", look_at({5, 1, 0}, {0, 1, 0}), 0.5f}};
  scene.environment.radiance = {0.5f, 0.25f, 0.125f};
  return scene;
}

TEST(LoadScene, ReadsBackWhatWasWritten) {
  TempFolder folder;
  Scene written = small_scene();
  write_gltf(written, folder / "scene.glb");
  Scene read = load_scene(folder / "scene.glb");
  ASSERT_EQ(read.objects.size(), 4u);
  EXPECT_TRUE(read.warnings.empty()) << read.warnings[0];
  for (int i = 0; i < 4; ++i) {
    const Object &a = written.objects[i], &b = read.objects[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.role, b.role);
    EXPECT_EQ(a.two_sided, b.two_sided);
    EXPECT_EQ(a.mesh.positions, b.mesh.positions);
    EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
  }
  EXPECT_EQ(read.objects[0].eta, 1.3);
  EXPECT_EQ(read.objects[0].medium.homogeneous.sigma_s, glm::dvec3(1000, 2000, 3000));
  EXPECT_EQ(read.objects[0].medium.homogeneous.sigma_a, glm::dvec3(1, 2, 3));
  EXPECT_EQ(read.objects[0].medium.g, 0.5);
  const Medium &marble = read.objects[1].medium, &original = written.objects[1].medium;
  ASSERT_TRUE(marble.heterogeneous());
  EXPECT_EQ(marble.sigma_t->values, original.sigma_t->values);
  EXPECT_EQ(marble.albedo->values, original.albedo->values);
  glm::dvec3 p(0.1, 0.2, 0.3);
  EXPECT_LT(glm::length(marble.at(p).sigma_s - original.at(p).sigma_s), 1e-12);
  EXPECT_EQ(read.objects[1].eta, 1);
  EXPECT_EQ(read.objects[2].albedo, glm::vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(read.objects[3].radiance, glm::vec3(10, 20, 5));
  ASSERT_EQ(read.cameras.size(), 2u);
  EXPECT_EQ(read.cameras[1].name, "side");
  EXPECT_FLOAT_EQ(read.cameras[0].y_fov, 0.6f);
  EXPECT_LT(glm::length(read.cameras[1].to_world[2] - written.cameras[1].to_world[2]), 1e-6f);
  EXPECT_EQ(read.environment.radiance, written.environment.radiance);
}

}  // namespace
}  // namespace alabaster

#include <gtest/gtest.h>

#include "scene/error.h"
#include "scene/files.h"
#include "scene/load.h"
#include "scene/shapes.h"
#include "scene/write_gltf.h"
#include "support/hostile.h"
#include "support/temp_folder.h"

namespace alabaster {
namespace {

using nlohmann::json;
using test::Glb;
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

/// good_scene() of the hostile tests, changed as JSON and read again.
template <typename Change>
Scene reloaded(Change change) {
  TempFolder folder;
  write_gltf(test::good_scene(), folder / "scene.glb");
  Glb glb = Glb::read(folder / "scene.glb");
  change(glb);
  write_file(folder / "scene.glb", glb.bytes());
  return load_scene(folder / "scene.glb");
}

std::string base64(const std::string& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned word = 0;
    for (std::size_t j = 0; j < 3; ++j) word = word << 8 | (i + j < bytes.size() ? (unsigned char)(bytes[i + j]) : 0);
    for (std::size_t j = 0; j < 4; ++j) text += i + j <= bytes.size() ? digits[word >> (18 - 6 * j) & 63] : '=';
  }
  return text;
}

TEST(LoadScene, TextWithBufferFileOrDataUri) {
  TempFolder folder;
  write_gltf(test::good_scene(), folder / "scene.glb");
  Glb glb = Glb::read(folder / "scene.glb");
  write_file(folder / "its data.bin", glb.buffer);
  for (const std::string& uri :
       {std::string("its%20data.bin"), "data:application/octet-stream;base64," + base64(glb.buffer)}) {
    glb.root["buffers"][0]["uri"] = uri;
    write_file(folder / "text.gltf", glb.root.dump());
    Scene scene = load_scene(folder / "text.gltf");
    ASSERT_EQ(scene.objects.size(), 4u);
    EXPECT_EQ(scene.objects[0].mesh.positions, test::good_scene().objects[0].mesh.positions);
  }
}

TEST(LoadScene, NodeTransformsAreChainedAndMirrorsKeepOutsideOutside) {
  Scene scene = reloaded([](Glb& glb) {
    json& nodes = glb.root["nodes"];
    nodes[test::marble]["scale"] = {-2, 1, 1};
    nodes[test::marble]["rotation"] = {0, std::sqrt(0.5), 0, std::sqrt(0.5)};  // 90 degrees about y: x to -z
    nodes.push_back({{"name", "root"}, {"translation", {10, 0, 0}}, {"children", {int(test::marble)}}});
    json& list = glb.root["scenes"][0]["nodes"];
    list = json::array();
    for (int i = 0; i < int(nodes.size()); ++i)
      if (i != test::marble) list.push_back(i);
  });
  const Object& marble = scene.objects.back();
  EXPECT_EQ(marble.name, "marble");
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_NEAR(signed_volume(marble.mesh), 2 * 0.04 * 0.04 * 0.04, 1e-8);  // 10 m out a float rounds to 1e-6 m
  // The box's middle (0.1, 0.02, 0) times -2 in x, then x to -z, then moved.
  glm::vec3 centre = bounds_of(marble.mesh).centre();
  EXPECT_LT(glm::distance(centre, glm::vec3(10, 0.02f, 0.2f)), 1e-5f);
  glm::dvec3 in_box(marble.medium.world_to_box * glm::dvec4(10, 0.02, 0.2, 1));
  EXPECT_LT(glm::distance(in_box, glm::dvec3(0.5)), 1e-9);
}

TEST(LoadScene, PrimitivesOfOneMaterialMergeOthersAreObjects) {
  Scene scene = reloaded([](Glb& glb) {
    json& meshes = glb.root["meshes"];
    meshes[test::ball]["primitives"].push_back(meshes[test::lamp]["primitives"][0]);
    meshes[test::ball]["primitives"].push_back(meshes[test::ball]["primitives"][0]);
    meshes[test::ball]["primitives"][2]["attributes"]["POSITION"] = 2 * test::marble;
    meshes[test::ball]["primitives"][2]["indices"] = 2 * test::marble + 1;
  });
  ASSERT_EQ(scene.objects.size(), 5u);
  EXPECT_EQ(scene.objects[0].name, "ball/ball");
  EXPECT_EQ(scene.objects[0].mesh.triangles.size(), 320u + 12u);
  EXPECT_EQ(scene.objects[1].name, "ball/lamp");
  EXPECT_EQ(scene.objects[1].role, Role::emissive);
}

TEST(LoadScene, StripsFansAndShortIndices) {
  auto with_mode = [](int mode, std::vector<std::uint16_t> indices) {
    return reloaded([&](Glb& glb) {
      glb.root["meshes"][test::ground]["primitives"][0]["mode"] = mode;
      json& accessor = glb.root["accessors"][2 * test::ground + 1];
      accessor["componentType"] = 5123;
      accessor["count"] = indices.size();
      for (std::size_t i = 0; i < indices.size(); ++i) glb.set(2 * test::ground + 1, i, indices[i]);
    });
  };
  Mesh original = test::good_scene().objects[test::ground].mesh;  // corners in order around
  for (const Mesh& mesh :
       {with_mode(5, {0, 1, 3, 2}).objects[test::ground].mesh, with_mode(6, {0, 1, 2, 3}).objects[test::ground].mesh}) {
    EXPECT_EQ(mesh.triangles.size(), 2u);
    EXPECT_LT(glm::distance(area_vector(mesh), area_vector(original)), 1e-9);
  }
}

TEST(LoadScene, PresetGivesCoefficientsAndIndex) {
  auto with_preset = [](Glb& glb) {
    json& material = glb.root["materials"][test::ball];
    material["extras"]["medium"] = {{"type", "preset"}, {"name", "marble"}};
    material.erase("extensions");
  };
  const Object ball = reloaded(with_preset).objects[0];
  EXPECT_LT(glm::distance(ball.medium.homogeneous.sigma_s, glm::dvec3(2190, 2620, 3000)), 1e-9);
  EXPECT_LT(glm::distance(ball.medium.homogeneous.sigma_a, glm::dvec3(2.1, 4.1, 7.1)), 1e-9);
  EXPECT_EQ(ball.eta, 1.5);
}

TEST(LoadScene, VolumeScatterExtensionIsInverted) {
  const double colour = 0.8, g = 0.4, attenuation = 0.3, distance = 0.002;
  for (const char* name : {"KHR_materials_volume_scatter", "KHR_materials_scatter"}) {
    Medium medium = reloaded([&](Glb& glb) {
                      json& material = glb.root["materials"][test::ball];
                      material.erase("extras");
                      material["extensions"][name] = {{"multiscatterColor", {colour, 1, 0}}, {"scatterAnisotropy", g}};
                      material["extensions"]["KHR_materials_volume"] = {{"attenuationColor", {attenuation, 0.5, 0.5}},
                                                                        {"attenuationDistance", distance}};
                    })
                        .objects[0]
                        .medium;
    glm::dvec3 sigma_t = medium.homogeneous.sigma_s + medium.homogeneous.sigma_a;
    EXPECT_NEAR(sigma_t.r * distance, -std::log(attenuation), 1e-12);
    double alpha = medium.homogeneous.sigma_s.r / sigma_t.r;
    // Kulla and Conty's s: alpha = (1 - s^2) / (1 - g s^2) solved for s, and the colour it stands for put back.
    double s = std::sqrt((1 - alpha) / (1 - alpha * g));
    double rest = 4.09712 + 4.20863 * colour - s;
    EXPECT_NEAR(rest * rest, 9.59217 + 41.6808 * colour + 17.7126 * colour * colour, 1e-6);
    EXPECT_NEAR(medium.homogeneous.sigma_a.g / sigma_t.g, 0, 1e-4);
    EXPECT_NEAR(medium.homogeneous.sigma_s.b / sigma_t.b, 0, 1e-4);
    EXPECT_EQ(medium.g, g);
  }
}

TEST(LoadScene, OneNumberIsGreyAndGridsMayBeNumbers) {
  Scene scene = reloaded([](Glb& glb) {
    glb.root["materials"][test::ball]["extras"]["medium"] = {
        {"type", "homogeneous"}, {"sigma_s", 50}, {"sigma_a", 2.5}};
    json& grid = glb.root["materials"][test::marble]["extras"]["medium"];
    grid["albedo"] = {0.9, 0.8, 0.7};
    grid["filter"] = "nearest";
  });
  EXPECT_EQ(scene.objects[0].medium.homogeneous.sigma_s, glm::dvec3(50));
  EXPECT_EQ(scene.objects[0].medium.homogeneous.sigma_a, glm::dvec3(2.5));
  EXPECT_EQ(scene.objects[0].medium.g, 0);
  EXPECT_FALSE(scene.objects[1].medium.sigma_t->trilinear);
  EXPECT_NEAR(scene.objects[1].medium.at({0.1, 0.02, 0}).sigma_s.b, 700, 1e-3);
}

TEST(LoadScene, SpecularChoosesTheIndexThatMirrorsAsMuch) {
  const auto eta = [](const json& specular, double ior) {
    return reloaded([&](Glb& glb) {
             json& extensions = glb.root["materials"][test::ball]["extensions"];
             extensions["KHR_materials_ior"] = {{"ior", ior}};
             extensions["KHR_materials_specular"] = specular;
           })
        .objects[0]
        .eta;
  };
  EXPECT_EQ(eta(json::object(), 1.5), 1.5);
  EXPECT_NEAR(eta({{"specularFactor", 0}}, 1.5), 1, 1e-12);
  const double f0 = 0.04, half = eta({{"specularFactor", 0.5}}, 1.5);
  EXPECT_NEAR(std::pow((half - 1) / (half + 1), 2), 0.5 * f0, 1e-12);
  const double brighter = eta({{"specularFactor", 0.5}, {"specularColorFactor", {3, 3, 3}}}, 1.5);
  EXPECT_NEAR(std::pow((brighter - 1) / (brighter + 1), 2), 1.5 * f0, 1e-12);
  EXPECT_THROW(eta({{"specularFactor", 2}}, 1.5), UserError);
  EXPECT_THROW(eta({{"specularColorFactor", {900, 900, 900}}}, 1.5), UserError);
}

TEST(LoadScene, EmissiveStrengthMultipliesTheFactor) {
  const Scene scene = reloaded([](Glb& glb) {
    json& material = glb.root["materials"][test::lamp];
    material["emissiveFactor"] = {1, 0.5, 0.25};
    material["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", 12}};
  });
  EXPECT_EQ(scene.objects[test::lamp].radiance, glm::vec3(12, 6, 3));
}

TEST(LoadScene, VolumeWithoutItsDefaultsIsRefusedOrClear) {
  const auto volume = [](const json& fields) {
    return reloaded([&](Glb& glb) {
             json& material = glb.root["materials"][test::ball];
             material.erase("extras");
             material["extensions"]["KHR_materials_scatter"] = {{"multiscatterColor", {0.5, 0.5, 0.5}}};
             material["extensions"]["KHR_materials_volume"] = fields;
           })
        .objects[0]
        .medium;
  };
  const Medium medium = volume({{"attenuationColor", {0.5, 0.25, 0.125}}, {"attenuationDistance", 0.01}});
  const glm::dvec3 sigma_t = medium.homogeneous.sigma_s + medium.homogeneous.sigma_a;
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(std::exp(-0.01 * sigma_t[c]), std::pow(0.5, c + 1), 1e-12);
  EXPECT_THROW(volume(json::object()), UserError);  // the default distance is infinite: nothing would scatter
  EXPECT_THROW(volume({{"attenuationDistance", 0.01}}), UserError);  // and the default colour is white
}

TEST(LoadScene, SizeScalesEverythingButTheCoefficients) {
  const auto sized = [](double size) {
    return reloaded([&](Glb& glb) {
      glb.root["extensions"]["KHR_lights_punctual"]["lights"] =
          json::array({{{"type", "point"}, {"intensity", 2}, {"extras", {{"radius", 0.01}}}}});
      glb.root["nodes"].push_back(
          {{"name", "bulb"}, {"translation", {0, 0.5, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
      glb.root["scenes"][0]["nodes"].push_back(glb.root["nodes"].size() - 1);
      if (size != 0) glb.root["scenes"][0]["extras"]["size"] = size;
    });
  };
  const Scene plain = sized(0), scene = sized(1);  // 0.1 m before: the ball
  EXPECT_NEAR(bounds_of(scene.objects[test::ball].mesh).size().y, 1, 1e-6);
  EXPECT_NEAR(bounds_of(scene.objects[test::lamp].mesh).centre().y, 3, 1e-5);
  EXPECT_NEAR(scene.cameras[0].to_world[3].z, 4, 1e-5);
  EXPECT_EQ(scene.objects[test::ball].medium.homogeneous.sigma_s.r, 1000);
  const glm::dvec3 p(0.1, 0.02, 0.013);
  EXPECT_LT(glm::distance(glm::dvec3(scene.objects[test::marble].medium.world_to_box * glm::dvec4(10.0 * p, 1)),
                          glm::dvec3(plain.objects[test::marble].medium.world_to_box * glm::dvec4(p, 1))),
            1e-6);
  EXPECT_NEAR(scene.lights[0].intensity.r, 200, 1e-3);  // as much light at ten times the distance
  EXPECT_NEAR(scene.lights[0].radius, 0.1, 1e-6);
  EXPECT_THROW(sized(-1), UserError);
}

TEST(LoadScene, SaysWhatItIgnores) {
  Scene scene = reloaded([](Glb& glb) {
    glb.root["cameras"].push_back(
        {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"zfar", 1}, {"znear", 0}}}});
    glb.root["nodes"].push_back({{"name", "flat"}, {"camera", 1}});
    glb.root["scenes"][0]["nodes"].push_back(glb.root["nodes"].size() - 1);
    glb.root["materials"][test::ball]["emissiveFactor"] = {1, 1, 1};
    glb.set(2 * test::ground + 1, 1, 0u);  // one triangle of the ground loses its area
  });
  EXPECT_EQ(scene.cameras.size(), 1u);
  EXPECT_EQ(scene.objects[test::ground].mesh.triangles.size(), 1u);
  std::string said;
  for (const std::string& warning : scene.warnings) said += warning + "\n";
  for (const char* word : {"orthographic", "emission", "without area"})
    EXPECT_NE(said.find(word), std::string::npos) << word << " in: " << said;
}

TEST(WriteGltf, LeavesNothingWhereItCannotWrite) {
  EXPECT_THROW(write_gltf(test::good_scene(), "/nowhere/at/all/scene.glb"), UserError);
}

}  // namespace
}  // namespace alabaster

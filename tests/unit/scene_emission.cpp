// Textured emission: lamps cut along their texels keep area and power, and are read from glTF.
#include <gtest/gtest.h>

#include <random>

#include "image/picture.h"
#include "scene/emission.h"
#include "scene/error.h"
#include "scene/load.h"
#include "scene/write_gltf.h"
#include "support/hostile.h"
#include "support/temp_folder.h"

namespace alabaster {
namespace {

using nlohmann::json;

double area_of(const Mesh& mesh) {
  double sum = 0;
  for (glm::uvec3 t : mesh.triangles) {
    const glm::dvec3 a = mesh.positions[t.x];
    sum += 0.5 * glm::length(glm::cross(glm::dvec3(mesh.positions[t.y]) - a, glm::dvec3(mesh.positions[t.z]) - a));
  }
  return sum;
}

Object lamp_of(const Mesh& mesh, glm::vec3 radiance) {
  Object lamp;
  lamp.name = "lamp";
  lamp.role = Role::emissive;
  lamp.mesh = mesh;
  lamp.radiance = radiance;
  return lamp;
}

/// Two triangles over [0, 2] x [0, 1], the texture across them.
Object sheet() { return lamp_of({{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}}, {1, 2, 4}); }
const std::vector<glm::vec2> across = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};

EmissionTexture noise(glm::ivec2 size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0, 1);
  EmissionTexture texture;
  texture.size = size;
  for (int i = 0; i < size.x * size.y; ++i) {
    const float r = uniform(random), g = uniform(random);
    texture.texels.emplace_back(r, g, 0.5f);
  }
  return texture;
}

glm::dvec3 mean_of(const EmissionTexture& texture) {
  glm::dvec3 sum(0);
  for (glm::vec3 v : texture.texels) sum += glm::dvec3(v) / double(texture.texels.size());
  return sum;
}

TEST(SceneEmission, AHalfDarkLampIsTwoLamps) {
  EmissionTexture texture;
  texture.size = {2, 1};
  texture.texels = {glm::vec3(0), glm::vec3(1)};
  const std::vector<Object> parts = cut_by_texels(sheet(), across, texture, "test");
  ASSERT_EQ(parts.size(), 2u);
  for (const Object& part : parts) {
    EXPECT_NEAR(area_of(part.mesh), 1, 1e-6);
    const bool bright = part.radiance != glm::vec3(0);
    EXPECT_EQ(part.radiance, bright ? glm::vec3(1, 2, 4) : glm::vec3(0));
    for (glm::vec3 p : part.mesh.positions) EXPECT_TRUE(bright ? p.x >= 1 : p.x <= 1) << p.x;
    for (glm::uvec3 t : part.mesh.triangles)
      EXPECT_GE(glm::cross(part.mesh.positions[t.y] - part.mesh.positions[t.x],
                           part.mesh.positions[t.z] - part.mesh.positions[t.x])
                    .z,
                0);
  }
}

TEST(SceneEmission, PartsKeepAreaAndPower) {
  for (glm::vec2 repeated : {glm::vec2(1, 1), glm::vec2(2, 3)}) {
    const EmissionTexture texture = noise({7, 5}, 3);
    std::vector<glm::vec2> texcoords = across;
    for (glm::vec2& at : texcoords) at *= repeated;
    const std::vector<Object> parts = cut_by_texels(sheet(), texcoords, texture, "test");
    EXPECT_EQ(parts.size(), most_emission_parts);
    double area = 0;
    glm::dvec3 power(0);
    for (const Object& part : parts) {
      area += area_of(part.mesh);
      power += area_of(part.mesh) * glm::dvec3(part.radiance);
    }
    EXPECT_NEAR(area, 2, 1e-5);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(power[c] / (2 * sheet().radiance[c] * mean_of(texture)[c]), 1, 1e-5);
  }
}

TEST(SceneEmission, LargeTexturesAreReducedAtTheirMean) {
  const EmissionTexture texture = noise({256, 128}, 5), small = reduced(texture);
  EXPECT_LE(small.size.x * small.size.y, most_emission_texels);
  EXPECT_EQ(small.size, glm::ivec2(64, 32));
  EXPECT_LT(glm::distance(mean_of(texture), mean_of(small)), 1e-5);
}

TEST(SceneEmission, Wraps) {
  EmissionTexture texture = noise({3, 1}, 7);
  texture.wrap[1] = EmissionTexture::Wrap::clamp;
  EXPECT_EQ(texture.at({-1, 5}), texture.texels[2]);
  texture.wrap[0] = EmissionTexture::Wrap::mirror;
  EXPECT_EQ(texture.at({-1, 0}), texture.texels[0]);
  EXPECT_EQ(texture.at({3, 0}), texture.texels[2]);
  EXPECT_EQ(texture.at({5, 0}), texture.texels[0]);
  texture.wrap[0] = EmissionTexture::Wrap::clamp;
  EXPECT_EQ(texture.at({9, 0}), texture.texels[2]);
}

TEST(SceneEmission, RepeatedTooOftenIsTheUsersToMend) {
  std::vector<glm::vec2> texcoords = across;
  for (glm::vec2& at : texcoords) at *= 1e4f;
  EXPECT_THROW(cut_by_texels(sheet(), texcoords, noise({7, 5}, 3), "test"), UserError);
}

/// good_scene() whose lamp has an emissiveTexture in a file beside it, and texture coordinates where wanted.
Scene with_texture(const std::string& image, bool coordinates) {
  test::TempFolder folder;
  write_gltf(test::good_scene(), folder / "scene.glb");
  test::Glb glb = test::Glb::read(folder / "scene.glb");
  write_png_rgb8(2, 1, {0, 0, 0, 255, 188, 255}, folder / "half.png");  // sRGB 188 is 0.5 of the light
  write_file(folder / "broken.png", "not a picture");
  glb.root["images"] = json::array({{{"uri", image}}});
  glb.root["textures"] = json::array({{{"source", 0}}});
  glb.root["materials"][3]["emissiveTexture"] = {{"index", 0}};
  if (coordinates) {
    const std::vector<glm::vec3> positions = test::good_scene().objects[3].mesh.positions;
    const std::size_t vertices = positions.size();
    glb.buffer.resize((glb.buffer.size() + 3) / 4 * 4);
    glb.root["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", glb.buffer.size()}, {"byteLength", vertices * sizeof(glm::vec2)}});
    glb.root["accessors"].push_back({{"bufferView", glb.root["bufferViews"].size() - 1},
                                     {"componentType", 5126},
                                     {"count", vertices},
                                     {"type", "VEC2"}});
    glb.root["meshes"][3]["primitives"][0]["attributes"]["TEXCOORD_0"] = glb.root["accessors"].size() - 1;
    for (glm::vec3 p : positions) {
      const glm::vec2 at(p.x / 0.1f + 0.5f, p.z / 0.1f + 0.5f);
      glb.buffer.append(reinterpret_cast<const char*>(&at), sizeof at);
    }
    glb.root["buffers"][0]["byteLength"] = glb.buffer.size();
  }
  write_file(folder / "scene.glb", glb.bytes());
  return load_scene(folder / "scene.glb");
}

TEST(SceneEmission, IsReadFromGltf) {
  const Scene scene = with_texture("half.png", true);
  ASSERT_EQ(scene.objects.size(), 5u);
  for (std::size_t i : {3u, 4u}) {
    const Object& part = scene.objects[i];
    EXPECT_EQ(part.role, Role::emissive);
    EXPECT_NEAR(area_of(part.mesh), 0.005, 1e-8);
    const bool bright = part.radiance.r > 0;
    if (bright) {
      EXPECT_NEAR(part.radiance.r, 20, 1e-4);
      EXPECT_NEAR(part.radiance.g, 10, 0.1);
    }
    for (glm::vec3 p : part.mesh.positions) EXPECT_TRUE(bright ? p.x > -1e-6f : p.x < 1e-6f);
  }
  EXPECT_NE(scene.objects[3].radiance, scene.objects[4].radiance);
}

TEST(SceneEmission, WithoutCoordinatesOrPictureItIsRefused) {
  EXPECT_THROW(with_texture("half.png", false), UserError);
  EXPECT_THROW(with_texture("broken.png", true), UserError);
}

}  // namespace
}  // namespace alabaster

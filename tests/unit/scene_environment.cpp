// The environment's picture: which way is where, what is drawn from it, and what the renderer's lights make of it.
#include <gtest/gtest.h>

#include <random>

#include "image/picture.h"
#include "lighting/sky_parts.h"
#include "scene/environment.h"
#include "scene/load.h"
#include "scene/shapes.h"
#include "scene/write_gltf.h"
#include "shared/lighting.h"
#include "support/temp_folder.h"

namespace alabaster {
namespace {

EnvironmentPicture numbered(glm::ivec2 size, float turn = 0) {
  std::vector<glm::vec3> radiance;
  for (int i = 0; i < size.x * size.y; ++i) radiance.emplace_back(i + 1, 2, 3);
  return EnvironmentPicture(size, radiance, turn);
}

EnvironmentPicture random_picture(glm::ivec2 size, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<glm::vec3> radiance;
  for (int i = 0; i < size.x * size.y; ++i) {
    const auto draw = [&] { return std::pow(static_cast<float>(random() % 1000) / 1000, 6.0f); };
    const float r = draw(), g = draw();
    radiance.push_back(i % 5 == 0 ? glm::vec3(0) : glm::vec3(r, g, 0.5f));
  }
  return EnvironmentPicture(size, radiance, 0.3f);
}

TEST(SceneEnvironment, TopIsUpAndTheMiddleLooksAlongMinusZ) {
  const EnvironmentPicture picture = numbered({8, 4});
  EXPECT_EQ(picture.texel_of({0, 1, 0}).y, 0);
  EXPECT_EQ(picture.texel_of({0, -1, 0}).y, 3);
  EXPECT_EQ(picture.texel_of(glm::normalize(glm::vec3(0.1, 0.1, -1))), glm::ivec2(4, 1));
  EXPECT_EQ(picture.texel_of(glm::normalize(glm::vec3(-0.1, -0.1, -1))), glm::ivec2(3, 2));
  EXPECT_EQ(picture.texel_of(glm::normalize(glm::vec3(1, -0.1, -0.1))), glm::ivec2(5, 2));  // right of the middle: +x
  EXPECT_EQ(picture.texel_of(glm::normalize(glm::vec3(-0.1, 0.1, 1))), glm::ivec2(0, 1));   // behind: the edges
  EXPECT_EQ(picture.texel_of(glm::normalize(glm::vec3(0.1, 0.1, 1))), glm::ivec2(7, 1));
  // A quarter turn, counter-clockwise from above, brings what was ahead to the left.
  const EnvironmentPicture turned = numbered({8, 4}, 0.25f);
  EXPECT_EQ(turned.radiance(glm::normalize(glm::vec3(-1, 0.1, -0.1))),
            picture.radiance(glm::normalize(glm::vec3(0.1, 0.1, -1))));
  for (const EnvironmentPicture& p : {picture, turned})
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 8; ++x)
        EXPECT_EQ(p.texel_of(glm::vec3(p.direction((glm::dvec2(x, y) + 0.5) / glm::dvec2(8, 4)))), glm::ivec2(x, y));
}

TEST(SceneEnvironment, DrawsInProportionToLight) {
  const EnvironmentPicture picture = random_picture({8, 4}, 1);
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(0, 1);
  const int n = 200000;
  std::vector<double> drawn(32), inverse(1);
  double area = 0, sphere = 0;
  for (int i = 0; i < n; ++i) {
    const glm::vec3 d = picture.draw({uniform(random), uniform(random), uniform(random), uniform(random)});
    ASSERT_NEAR(glm::length(d), 1, 1e-5);
    const glm::ivec2 at = picture.texel_of(d);
    drawn[static_cast<std::size_t>(at.y * 8 + at.x)] += 1;
    ASSERT_GT(picture.density(d), 0);
    area += 1 / static_cast<double>(picture.density(d)) / n;  // the solid angle that shines
  }
  double shining = 0;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x) {
      const glm::vec3 v = picture.texel({x, y});
      const double light = (v.r + v.g + v.b) / 3.0 * picture.solid_angle(y), share = light / picture.total();
      EXPECT_NEAR(drawn[static_cast<std::size_t>(y * 8 + x)] / n, share, 5 * std::sqrt(share / n) + 1e-9)
          << x << " " << y;
      shining += light > 0 ? picture.solid_angle(y) : 0;
      sphere += picture.solid_angle(y);
    }
  EXPECT_NEAR(area, shining, 0.01 * shining);
  EXPECT_NEAR(sphere, 4 * M_PI, 1e-9);
  EXPECT_NEAR(EnvironmentPicture({4, 2}, std::vector<glm::vec3>(8, {1, 2, 3})).evenness(), 1, 1e-12);
  EXPECT_LT(picture.evenness(), 0.9);
}

double irradiance(const EnvironmentPicture& picture, glm::dvec3 normal) {
  const int n = 256;  // a multiple of every picture's rows
  double sum = 0;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < 2 * n; ++x) {
      const glm::dvec3 d = picture.direction({(x + 0.5) / (2 * n), (y + 0.5) / n});
      const double solid_angle = M_PI / n * (std::cos(M_PI * y / n) - std::cos(M_PI * (y + 1) / n));
      sum += static_cast<double>(picture.radiance(glm::vec3(d)).r) * std::max(0.0, glm::dot(d, normal)) * solid_angle;
    }
  return sum;
}

// A uniform picture, one that varies wildly, and a sun, on normals all around; more parts come nearer.
TEST(SceneEnvironment, PartsShineAsThePictureDoes) {
  std::vector<glm::vec3> sun(512 * 256, glm::vec3(0.1f));
  sun[60 * 512 + 100] = glm::vec3(3000);
  struct Case {
    EnvironmentPicture picture;
    double tolerance[2];
  };
  const std::vector<Case> cases = {
      {EnvironmentPicture({4, 2}, std::vector<glm::vec3>(8, glm::vec3(2))), {0.005, 0.001}},
      {random_picture({16, 8}, 3), {0.025, 0.004}},
      {EnvironmentPicture({512, 256}, sun), {0.01, 0.002}}};
  for (const Case& c : cases) {
    double most = 0, worst[2] = {0, 0};
    const std::vector<SkyPart> parts[2] = {cut_sky(c.picture, 64), cut_sky(c.picture, 512)};
    for (const glm::vec3& n : icosphere(1).positions) {
      const double exact = irradiance(c.picture, n);
      most = std::max(most, exact);
      for (int k = 0; k < 2; ++k) {
        double sum = 0;
        for (const SkyPart& part : parts[k])
          sum +=
              static_cast<double>(part.flux.r) * cosine_above_horizon<double>(glm::dot(n, part.direction), part.spread);
        worst[k] = std::max(worst[k], std::abs(sum - exact));
      }
    }
    for (int k = 0; k < 2; ++k) {
      std::printf("%zu parts: irradiance off by at most %.2f %% of the largest\n", parts[k].size(),
                  100 * worst[k] / most);
      EXPECT_LE(parts[k].size(), k ? 512u : 64u);
      EXPECT_LT(worst[k], c.tolerance[k] * most);
    }
  }
}

TEST(SceneEnvironment, GoesRoundThroughAFile) {
  test::TempFolder folder;
  Scene scene;
  Object ball;
  ball.mesh = icosphere(1);
  scene.objects = {ball};
  scene.cameras.resize(1);
  scene.environment.picture = std::make_shared<EnvironmentPicture>(random_picture({8, 4}, 4));
  write_gltf(scene, folder / "lit.glb");
  const Scene read = load_scene(folder / "lit.glb");
  ASSERT_TRUE(read.environment.picture);
  EXPECT_TRUE(read.warnings.empty());
  EXPECT_EQ(read.environment.picture->texels(), scene.environment.picture->texels());
  EXPECT_NEAR(read.environment.picture->turn(), 0.3f, 1e-6);
  EXPECT_FALSE(read.environment.dark());
  EXPECT_FALSE(read.environment.grey());
  EXPECT_EQ(read_environment_picture(folder / "lit-environment.exr", 2, 0)->texel({3, 2}),
            2.0f * scene.environment.picture->texel({3, 2}));
}

}  // namespace
}  // namespace alabaster

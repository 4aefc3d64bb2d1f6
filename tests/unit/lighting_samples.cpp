// Light samples: power is shared out, nothing is lost, points are spread evenly; and where shadow maps look.
#include <gtest/gtest.h>

#include "lighting/beam_groups.h"
#include "lighting/shadow_views.h"
#include "scene/error.h"
#include "scene/shapes.h"

namespace alabaster {
namespace {

Object light(Mesh mesh, glm::vec3 radiance, bool two_sided = false) {
  Object object;
  object.role = Role::emissive;
  object.mesh = std::move(mesh);
  object.radiance = radiance;
  object.two_sided = two_sided;
  return object;
}

Object solid(Role role, Mesh mesh) {
  Object object;
  object.role = role;
  object.mesh = std::move(mesh);
  return object;
}

TEST(LightSamples, ShareOutByPowerAndLoseNothing) {
  Scene scene;  // powers 1 : 6 : 2 (two-sided), one dark and one without area
  scene.objects = {light(quad(1, 1), {1, 1, 1}), light(quad(2, 3), {1, 1, 1}), light(quad(1, 1), {1, 1, 1}, true),
                   light(quad(1, 1), {0, 0, 0}), light(quad(0, 0), {1, 1, 1})};
  for (int n : {1, 3, 12, 39, 256}) {
    const LightSamples lights = sample_lights(scene, n);
    EXPECT_EQ(lights.area.size(), static_cast<std::size_t>(std::max(n, 3)));
    int count[5] = {};
    double intensity[5] = {};
    for (const LightSample& s : lights.area) ++count[s.object], intensity[s.object] += s.intensity.r;
    EXPECT_NEAR(intensity[0], 1, 1e-5);
    EXPECT_NEAR(intensity[1], 6, 1e-5);
    EXPECT_NEAR(intensity[2], 1, 1e-5);
    EXPECT_EQ(count[3] + count[4], 0);
    for (int i = 0; i < 3; ++i) EXPECT_GE(count[i], 1);
    EXPECT_NEAR(count[1], 1 + std::max(0, n - 3) * 6 / 9.0, 1);
  }
}

TEST(LightSamples, CoverTheAreaEvenly) {
  Scene scene;
  const glm::dmat4 place = translation({1, 2, 3}) * rotation({1, 2, 0}, 70);
  scene.objects = {light(transformed(quad(2, 1), place), {3, 2, 1})};
  const int n = 64;
  const LightSamples lights = sample_lights(scene, n);
  const glm::dmat4 back = glm::inverse(place);
  int cells[8][8] = {};
  for (const LightSample& s : lights.area) {
    const glm::dvec3 p = back * glm::dvec4(s.position, 1), normal = back * glm::dvec4(s.normal, 0);
    EXPECT_NEAR(p.y, 0, 1e-6);
    EXPECT_NEAR(normal.y, 1, 1e-6);
    ASSERT_LE(std::max(std::abs(p.x), 2 * std::abs(p.z)), 1);
    ++cells[static_cast<int>(4 * (p.x + 1)) / 2][static_cast<int>(8 * (p.z + 0.5)) / 2];
  }
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) EXPECT_NEAR(cells[i][j], n / 16, 2) << i << " " << j;
  const LightSamples again = sample_lights(scene, n);
  for (int i = 0; i < n; ++i) EXPECT_EQ(lights.area[i].position, again.area[i].position);
}

// A part of a far lamp is one beam, of a near one none but single samples are.
TEST(LightSamples, BeamsTakeSamplesThatLieTogether) {
  const GridFrame frame = choose_frame({{-1, -1, -1}, {1, 1, 1}}, 16);
  for (double away : {1.5, 5.0, 30.0, 300.0}) {
    Scene scene;
    scene.objects = {light(transformed(quad(2, 3), translation({0, away, 0})), {3, 2, 1}),
                     light(transformed(quad(1, 1), translation({away, 0, 0})), {1, 1, 1})};
    const LightSamples lights = sample_lights(scene, 64);
    const std::vector<std::uint32_t> groups = beam_groups(lights, frame);
    std::size_t at = 0;
    for (std::uint32_t group : groups) {
      glm::dvec3 middle(0);
      for (std::size_t i = at; i < at + group; ++i) middle += glm::dvec3(lights.area[i].position) / double(group);
      for (std::size_t i = at; i < at + group; ++i) {
        EXPECT_EQ(lights.area[i].object, lights.area[at].object);
        EXPECT_LE(glm::distance(glm::dvec3(lights.area[i].position), middle), 0.15 * (away - 1));
      }
      at += group;
    }
    EXPECT_EQ(at, lights.area.size());
    EXPECT_EQ(groups.size() == 64, away == 1.5);
    EXPECT_EQ(groups.size() == 2, away >= 30);
    std::printf("%.1f away: %zu beams\n", away, groups.size());
  }
}

TEST(LightSamples, DirectionsAreEven) {
  Scene scene;
  EXPECT_TRUE(sample_lights(scene, 1, 100).directions.empty());  // a dark environment needs none
  scene.environment.radiance = {1, 1, 1};
  const LightSamples lights = sample_lights(scene, 1, 200);
  ASSERT_EQ(lights.directions.size(), 200u);
  glm::dvec3 normal(1, 2, -2);
  normal /= 3;
  double irradiance = 0;
  for (const glm::vec3& d : lights.directions) {
    EXPECT_NEAR(glm::length(d), 1, 1e-6);
    irradiance += std::max(0.0, glm::dot(normal, glm::dvec3(d))) * 4 / 200;
  }
  EXPECT_NEAR(irradiance, 1, 0.01);
}

TEST(LightSamples, TooManyAreRefused) {
  Scene scene;
  for (int n : {0, -5, 1025}) EXPECT_THROW(sample_lights(scene, n), UserError);
  EXPECT_THROW(sample_lights(scene, 1, -1), UserError);
  for (int i = 0; i < 1100; ++i) scene.objects.push_back(light(quad(1, 1), {1, 1, 1}));
  EXPECT_THROW(sample_lights(scene, 1), UserError);
}

TEST(ShadowViews, FocusIsOnTranslucentThingsAndTheirNeighbours) {
  Scene scene;
  scene.objects = {solid(Role::translucent, icosphere(3, 1)), solid(Role::opaque, quad(100, 100)),
                   solid(Role::opaque, transformed(box({0.2f, 2, 0.2f}), translation({1.3, 0, 0}))),
                   light(transformed(quad(1, 1), translation({0, 5, 0})), {1, 1, 1})};
  const Focus focus = shadow_focus(scene);
  EXPECT_GT(focus.radius, 1.1);
  EXPECT_LT(focus.radius, 2);
  scene.objects.erase(scene.objects.begin() + 2);
  EXPECT_NEAR(shadow_focus(scene).radius, 1, 1e-3);
  EXPECT_EQ(shadow_focus({}).radius, 0);
}

TEST(ShadowViews, HoldTheFocusWhole) {
  const Focus focus{{1, 2, 3}, 0.5, {}};
  LightSample sample;
  for (double distance : {0.1, 0.5, 0.57, 0.6, 1.0, 50.0}) {
    sample.position = glm::vec3(focus.centre + glm::dvec3(0, distance, 0));
    sample.normal = {0, -1, 0};
    const std::vector<ShadowView> views = point_views(sample, focus, 0.01, 64);
    EXPECT_EQ(views.size(), distance < 0.5 / 0.8660254 ? 5u : 1u) << distance;
    for (const glm::vec3& q : icosphere(3, 0.5f).positions) {
      const glm::vec3 p = q + glm::vec3(focus.centre);
      if (p.y > sample.position.y - 0.02) continue;  // not lit
      bool held = false;
      for (const ShadowView& view : views) {
        const glm::vec4 clip = view.to_clip * glm::vec4(p, 1);
        held = held || (std::max(std::abs(clip.x), std::abs(clip.y)) < clip.w && clip.z > 0);
      }
      EXPECT_TRUE(held) << distance;
    }
  }
  sample.normal = {0, 1, 0};
  EXPECT_TRUE(point_views(sample, focus, 0.01, 64).empty());
  sample.kind = light_two_sided;
  EXPECT_EQ(point_views(sample, focus, 0.01, 64).size(), 1u);
  sample.position = glm::vec3(focus.centre);
  EXPECT_EQ(point_views(sample, focus, 0.01, 64).size(), 6u);

  Bounds everything;
  everything.add({-10, -10, -10});
  everything.add({10, 10, 10});
  for (const glm::vec3& from : {glm::vec3(1, 0, 0), glm::vec3(0, -1, 0), glm::vec3(0.3f, 0.4f, -0.5f)}) {
    const ShadowView view = direction_view(from, focus, everything, 64);
    for (const glm::vec3& q : icosphere(2, 0.5f).positions) {
      const glm::vec4 clip = view.to_clip * glm::vec4(q + glm::vec3(focus.centre), 1);
      EXPECT_LT(std::max(std::abs(clip.x), std::abs(clip.y)), 1);
      EXPECT_GT(clip.z, 0);
      EXPECT_LT(clip.z, 1);
    }
    // Nearer to where the light comes from is nearer in depth.
    EXPECT_LT((view.to_clip * glm::vec4(from, 1)).z, (view.to_clip * glm::vec4(-from, 1)).z);
  }
}

TEST(ShadowViews, FitTightlyAroundThePoints) {
  Scene scene;  // a flat plate seen face on fills the map; the sphere around it is 1.4 times as wide
  scene.objects = {solid(Role::translucent, box({1, 0.02f, 1}))};
  const Focus focus = shadow_focus(scene);
  LightSample sample;
  sample.position = {0.3f, 5, 0.2f};
  sample.normal = {0, -1, 0};
  const ShadowView near = point_views(sample, focus, 1, 512).at(0);
  const ShadowView far = direction_view({0.1f, 1, 0}, focus, bounds_of(scene.objects[0].mesh), 512);
  for (const ShadowView& view : {near, far}) {
    float widest = 0;
    for (const glm::vec3& p : scene.objects[0].mesh.positions) {
      const glm::vec4 clip = view.to_clip * glm::vec4(p, 1);
      widest = std::max(widest, std::max(std::abs(clip.x), std::abs(clip.y)) / clip.w);
    }
    EXPECT_NEAR(widest, 1 / (1 + 8 / 512.0), 1e-4);  // four texels of margin
  }
}

}  // namespace
}  // namespace alabaster

// lighting/ray_tree.glsl: what rays meet first, against all triangles one by one in double precision.
#include <random>

#include "lighting/ray_tree.h"
#include "scene/shapes.h"
#include "support/lighting_twin.h"
#include "support/lit_scene.h"

namespace alabaster {
namespace {

class LightingTree : public GpuTest {
 protected:
  struct Ray {
    glm::vec3 from, way;
  };

  std::vector<RayHit> on_device(const RayTree& tree, const std::vector<Ray>& rays) {
    const DeviceRayTree device = upload_ray_tree(context, tree);
    const gpu::Pass pass(context, "test/rays.comp");
    const gpu::Buffer in = gpu::make_buffer(context, rays, "rays"), out(context, rays.size() * sizeof(RayHit), "hits");
    gpu::Bindings bindings = device.bindings();
    bindings.push_back({"rays", in});
    bindings.push_back({"hits", out});
    const auto count = static_cast<std::uint32_t>(rays.size());
    gpu::Commands commands(context);
    commands.dispatch(pass, {count, 1, 1}, bindings, count);
    commands.submit();
    return gpu::download<RayHit>(context, out);
  }

  /// The nearest triangle of the tree that the ray meets, closed objects from outside only.
  static double nearest(const std::vector<RayTriangle>& triangles, const Ray& ray) {
    double least = INFINITY;
    for (const RayTriangle& t : triangles) {
      const glm::dvec3 a = t.corner, b = a + glm::dvec3(t.edge1), c = a + glm::dvec3(t.edge2);
      if (t.closed && glm::dot(glm::cross(b - a, c - a), glm::dvec3(ray.way)) >= 0) continue;
      least = std::min(least, hit_distance(ray.from, ray.way, a, b, c));
    }
    return least;
  }

  void expect_twin(const Scene& scene, const std::vector<Ray>& rays, std::size_t least_hits) {
    const RayTree tree = make_ray_tree(scene);
    const std::vector<RayHit> hits = on_device(tree, rays);
    std::size_t met = 0, apart = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const double expected = nearest(tree.triangles, rays[i]);
      met += std::isfinite(expected);
      const bool found = hits[i].triangle != ray_missed;
      // Rays along a silhouette may go either way.
      if (found != std::isfinite(expected) ||
          (found && std::abs(hits[i].distance - expected) > 1e-4 * (1 + expected))) {
        ++apart;
        continue;
      }
      if (!found) continue;
      const RayTriangle& t = tree.triangles.at(hits[i].triangle);
      const glm::dvec3 place = glm::dvec3(rays[i].from) + double(hits[i].distance) * glm::dvec3(rays[i].way);
      const glm::dvec3 n = glm::normalize(glm::cross(glm::dvec3(t.edge1), glm::dvec3(t.edge2)));
      EXPECT_NEAR(glm::dot(n, place - glm::dvec3(t.corner)), 0, 1e-4);
    }
    EXPECT_GE(met, least_hits);
    EXPECT_LE(apart, rays.size() / 1000);
  }

  std::mt19937 engine{3};
  glm::vec3 random_direction() {
    std::normal_distribution<float> normal;
    return glm::normalize(glm::vec3(normal(engine), normal(engine), normal(engine)));
  }
};

/// A torus, a ball beside it and an open plate under both.
Scene torus_ball_and_plate() {
  Scene scene;
  scene.objects = {make_object(Role::translucent, torus(1, 0.4f, 48, 24)),
                   make_object(Role::opaque, transformed(quad(4, 4), translation({0, -0.7, 0}))),
                   make_object(Role::translucent, transformed(icosphere(3, 0.4f), translation({0.3, 0.9, 0.1})))};
  return scene;
}

TEST_F(LightingTree, RandomRaysMeetWhatTheyMeet) {
  std::uniform_real_distribution<float> uniform(-2, 2);
  std::vector<Ray> rays;
  for (int i = 0; i < 4000; ++i)
    rays.push_back({{uniform(engine), uniform(engine), uniform(engine)}, random_direction()});
  expect_twin(torus_ball_and_plate(), rays, 1000);
}

TEST_F(LightingTree, GrazingRaysOffASurfaceLeaveItUnhindered) {
  // From a hair below each face's middle, a few degrees above it: the own surface must not stop them.
  const Scene ball = [] {
    Scene scene;
    scene.objects = {make_object(Role::translucent, icosphere(3))};
    return scene;
  }();
  std::vector<Ray> rays;
  for (const Receiver& r : face_receivers(ball.objects[0].mesh)) {
    const glm::vec3 side = glm::normalize(glm::cross(r.normal, random_direction()));
    rays.push_back({r.position - 1e-3f * r.normal, glm::normalize(side + 0.05f * r.normal)});
  }
  for (const RayHit& hit : on_device(make_ray_tree(ball), rays)) EXPECT_EQ(hit.triangle, ray_missed);

  const Scene scene = torus_ball_and_plate();
  rays.clear();
  for (const Receiver& r : face_receivers(scene.objects[0].mesh)) {
    const glm::vec3 side = glm::normalize(glm::cross(r.normal, random_direction()));
    rays.push_back({r.position + 1e-4f * r.normal, glm::normalize(side + 0.03f * r.normal)});
  }
  expect_twin(scene, rays, 100);
}

TEST_F(LightingTree, RaysAlongAxesAndThroughCorners) {
  const Scene scene = torus_ball_and_plate();
  std::vector<Ray> rays;
  for (const glm::vec3& p : scene.objects[2].mesh.positions)  // through vertices: no slip between triangles
    rays.push_back({{0.3f, 5, 0.1f}, glm::normalize(p - glm::vec3(0.3f, 5, 0.1f))});
  std::size_t met = 0;
  for (const RayHit& hit : on_device(make_ray_tree(scene), rays)) met += hit.triangle != ray_missed;
  EXPECT_EQ(met, rays.size());  // the plate stops what misses the ball
  rays.clear();
  std::uniform_real_distribution<float> uniform(-1.5f, 1.5f);
  for (int i = 0; i < 1000; ++i) {
    glm::vec3 way(0);
    way[i % 3] = i % 2 ? 1.f : -1.f;
    rays.push_back({{uniform(engine), uniform(engine), uniform(engine)}, way});
  }
  expect_twin(scene, rays, 200);
}

TEST_F(LightingTree, ScenesOfOneTriangleAndOfNone) {
  Scene scene;
  Mesh one;
  one.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  one.triangles = {{0, 1, 2}};
  scene.objects = {make_object(Role::opaque, one)};
  const std::vector<Ray> rays{{{0.2f, 0.2f, 1}, {0, 0, -1}}, {{0.2f, 0.2f, -1}, {0, 0, 1}}, {{2, 2, 1}, {0, 0, -1}}};
  expect_twin(scene, rays, 2);
  scene.objects.clear();
  expect_twin(scene, rays, 0);
}

}  // namespace
}  // namespace alabaster

// The tree of all triangles: its walk on the CPU against brute force. (Its walk in compute: gpu/lighting_tree.cpp.)
#include "lighting/ray_tree.h"

#include <gtest/gtest.h>

#include <random>

#include "scene/shapes.h"
#include "support/lighting_twin.h"
#include "support/lit_scene.h"

namespace alabaster {
namespace {

Scene scattered_balls() {
  Scene scene;
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 12; ++i) {
    const glm::dvec3 at(uniform(engine), uniform(engine), uniform(engine));
    scene.objects.push_back(
        make_object(i % 2 ? Role::translucent : Role::opaque, transformed(icosphere(2, 0.3f), translation(at))));
  }
  scene.objects.push_back(make_object(Role::opaque, quad(3, 3)));
  return scene;
}

TEST(RayTree, MeetsWhatBruteForceMeets) {
  const Scene scene = scattered_balls();
  const RayTree tree = make_ray_tree(scene);
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int hits = 0, differ = 0;
  for (int k = 0; k < 3000; ++k) {
    const glm::vec3 from(2 * uniform(engine), 2 * uniform(engine), 2 * uniform(engine));
    const glm::vec3 ray = glm::normalize(glm::vec3(uniform(engine), uniform(engine), k % 7 ? uniform(engine) : 0));
    double nearest = INFINITY;
    for (const Object& object : scene.objects)
      for (const glm::uvec3& t : object.mesh.triangles) {
        const auto& p = object.mesh.positions;
        const glm::dvec3 a = p[t.x], b = p[t.y], c = p[t.z];
        if (object.role == Role::translucent && glm::dot(glm::cross(b - a, c - a), glm::dvec3(ray)) >= 0) continue;
        nearest = std::min(nearest, hit_distance(from, ray, a, b, c));
      }
    const RayHit hit = trace(tree, from, ray);
    hits += std::isfinite(nearest);
    if (std::isfinite(nearest) != (hit.triangle != UINT32_MAX) ||
        (std::isfinite(nearest) && std::abs(hit.distance - nearest) > 1e-5))
      ++differ;  // through an edge, by rounding
  }
  EXPECT_GT(hits, 500);
  EXPECT_LE(differ, 2);
}

TEST(RayTree, HoldsEveryTriangleOnceInsideItsBoxes) {
  const Scene scene = scattered_balls();
  const RayTree tree = make_ray_tree(scene);
  std::size_t triangles = 0, leaves = 0;
  for (const Object& object : scene.objects) triangles += object.mesh.triangles.size();
  ASSERT_EQ(tree.triangles.size(), triangles);
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const RayNode& node = tree.nodes[i];
    if (node.count == 0) {
      EXPECT_GT(node.link, i + 2);
      continue;
    }
    EXPECT_LE(node.count, 4u);
    leaves += node.count;
    for (uint k = node.link; k < node.link + node.count; ++k) {
      const RayTriangle& t = tree.triangles[k];
      for (glm::vec3 corner : {t.corner, t.corner + t.edge1, t.corner + t.edge2})
        EXPECT_TRUE(glm::all(glm::greaterThanEqual(corner, node.low - 1e-6f)) &&
                    glm::all(glm::lessThanEqual(corner, node.high + 1e-6f)));
    }
  }
  EXPECT_EQ(leaves, triangles);
}

TEST(RayTree, ManyTrianglesInOnePlaceAreStillParted) {
  Scene scene;
  Mesh mesh = quad(1, 1);
  for (int i = 0; i < 100; ++i) mesh.triangles.push_back(mesh.triangles[0]);
  scene.objects.push_back(make_object(Role::opaque, mesh));
  const RayTree tree = make_ray_tree(scene);
  for (const RayNode& node : tree.nodes) EXPECT_LE(node.count, 4u);
  EXPECT_TRUE(make_ray_tree(Scene()).nodes.empty());
}

}  // namespace
}  // namespace alabaster

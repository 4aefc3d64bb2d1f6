#include <gtest/gtest.h>

#include "scene/error.h"
#include "scene/inside.h"
#include "scene/mesh_check.h"
#include "scene/mesh_weld.h"
#include "scene/shapes.h"

namespace alabaster {
namespace {

struct Checked {
  Mesh mesh;
  std::vector<std::string> warnings;
};

/// Runs the check and proves that what comes out bounds a solid.
Checked check(const Mesh& mesh) {
  Checked result;
  result.mesh = checked_solid(mesh, "thing", "file.glb", result.warnings);
  EXPECT_LT(glm::length(area_vector(result.mesh)), 1e-6 * area(result.mesh));
  EXPECT_GT(signed_volume(result.mesh), 0);
  return result;
}

bool mentions(const Checked& checked, const std::string& word) {
  for (const std::string& warning : checked.warnings)
    if (warning.find(word) != std::string::npos) return true;
  return false;
}

std::string failure(const Mesh& mesh) {
  std::vector<std::string> warnings;
  try {
    checked_solid(mesh, "thing", "file.glb", warnings);
  } catch (const UserError& error) {
    return error.what();
  }
  return "accepted";
}

/// Every triangle with vertices of its own, as flat-shaded glTF has them.
Mesh split(const Mesh& mesh) {
  Mesh result;
  for (glm::uvec3 t : mesh.triangles) {
    unsigned first = unsigned(result.positions.size());
    for (int i = 0; i < 3; ++i) result.positions.push_back(mesh.positions[t[i]]);
    result.triangles.push_back({first, first + 1, first + 2});
  }
  return result;
}

TEST(MeshCheck, GoodMeshesPassUntouched) {
  for (const Mesh& mesh : {icosphere(3), box({1, 2, 3}, 3), torus(1, 0.3f, 32, 16), cylinder(0.1f, 4, 12)}) {
    Checked result = check(mesh);
    EXPECT_TRUE(result.warnings.empty());
    EXPECT_EQ(result.mesh.positions, mesh.positions);
    EXPECT_EQ(result.mesh.triangles, mesh.triangles);
  }
}

TEST(MeshCheck, WeldsSplitVertices) {
  Mesh ball = icosphere(3);
  Checked result = check(split(ball));
  EXPECT_TRUE(result.warnings.empty());
  EXPECT_EQ(result.mesh.positions.size(), ball.positions.size());
}

TEST(MeshCheck, WeldsAcrossRoundingGaps) {
  Mesh ball = split(icosphere(3));
  for (std::size_t i = 0; i < ball.positions.size(); ++i) ball.positions[i].x += 2e-7f * float(i % 3);
  Checked result = check(ball);
  EXPECT_TRUE(mentions(result, "welding"));
  EXPECT_EQ(result.mesh.positions.size(), icosphere(3).positions.size());
}

TEST(MeshCheck, TurnsAnInvertedMesh) {
  Checked result = check(flipped(torus(1, 0.3f, 32, 16)));
  EXPECT_TRUE(mentions(result, "inside out"));
}

TEST(MeshCheck, TurnsSingleTriangles) {
  Mesh ball = icosphere(3);
  for (std::size_t i = 0; i < ball.triangles.size(); i += 7) std::swap(ball.triangles[i].x, ball.triangles[i].y);
  Checked result = check(ball);
  EXPECT_TRUE(mentions(result, "183 triangles turned"));
  EXPECT_NEAR(signed_volume(result.mesh), signed_volume(icosphere(3)), 1e-9);
}

TEST(MeshCheck, DropsDegenerateAndDuplicateTriangles) {
  Mesh ball = icosphere(2);
  ball.triangles.push_back({3, 3, 5});
  ball.triangles.push_back(ball.triangles[7]);
  ball.triangles.push_back({ball.triangles[9].y, ball.triangles[9].x, ball.triangles[9].z});
  Checked result = check(ball);
  EXPECT_TRUE(mentions(result, "1 degenerate triangle "));
  EXPECT_TRUE(mentions(result, "2 duplicate triangles "));
  EXPECT_EQ(result.mesh.triangles.size(), icosphere(2).triangles.size());
}

TEST(MeshCheck, FillsSmallHoles) {
  Mesh ball = icosphere(4);
  double volume = signed_volume(ball);
  ball.triangles.erase(ball.triangles.begin() + 100, ball.triangles.begin() + 105);
  ball.triangles.erase(ball.triangles.begin() + 3000);
  Checked result = check(ball);
  EXPECT_TRUE(mentions(result, "filled"));
  EXPECT_NEAR(signed_volume(result.mesh), volume, 1e-3 * volume);
}

TEST(MeshCheck, FillsHolesThatTouchAtAVertex) {
  Mesh ball = icosphere(4);
  unsigned shared = ball.triangles[1000].x;
  std::vector<std::size_t> around;
  for (std::size_t t = 0; t < ball.triangles.size(); ++t)
    if (ball.triangles[t].x == shared || ball.triangles[t].y == shared || ball.triangles[t].z == shared)
      around.push_back(t);
  ASSERT_EQ(around.size(), 6u);
  // Two of the six triangles around a vertex that have no edge in common.
  auto share_edge = [&](std::size_t a, std::size_t b) {
    int common = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) common += ball.triangles[a][i] == ball.triangles[b][j];
    return common == 2;
  };
  std::size_t other = 1;
  while (share_edge(around[0], around[other])) ++other;
  ball.triangles.erase(ball.triangles.begin() + around[other]);
  ball.triangles.erase(ball.triangles.begin() + around[0]);
  Checked result = check(ball);
  EXPECT_TRUE(mentions(result, "2 holes filled"));
  EXPECT_EQ(result.mesh.triangles.size(), icosphere(4).triangles.size());
}

TEST(MeshCheck, ClosesTheGapOfATJunction) {
  // A vertex in the middle of an edge, for one of its two triangles only.
  Mesh split_box = box({1, 1, 1}, 1);
  glm::uvec3 t = split_box.triangles[0];
  unsigned middle = unsigned(split_box.positions.size());
  split_box.positions.push_back(0.5f * (split_box.positions[t.x] + split_box.positions[t.y]));
  split_box.triangles[0] = {t.x, middle, t.z};
  split_box.triangles.push_back({middle, t.y, t.z});
  Checked result = check(split_box);
  EXPECT_TRUE(mentions(result, "1 hole filled"));
  EXPECT_NEAR(signed_volume(result.mesh), 1, 1e-6);
  for (glm::uvec3 triangle : result.mesh.triangles) {  // the patch has no area: it must be gone
    glm::vec3 a = result.mesh.positions[triangle.x], b = result.mesh.positions[triangle.y],
              c = result.mesh.positions[triangle.z];
    EXPECT_GT(glm::length(glm::cross(b - a, c - a)), 0.1f);
  }
}

TEST(MeshCheck, SaysWhereLargeHolesAre) {
  Mesh open = box({2, 2, 2}, 4);
  std::erase_if(open.triangles, [&](glm::uvec3 t) {
    return open.positions[t.x].y > 0.99f && open.positions[t.y].y > 0.99f && open.positions[t.z].y > 0.99f;
  });
  std::string message = failure(open);
  EXPECT_NE(message.find("file.glb: mesh 'thing' is not closed: 1 hole (16 edges around (0, 1, 0))"), std::string::npos)
      << message;
}

TEST(MeshCheck, CavitiesKeepTheirWinding) {
  Mesh shell = joined(icosphere(3), flipped(icosphere(3, 0.5f)));
  Checked good = check(shell);
  EXPECT_TRUE(good.warnings.empty());
  EXPECT_NEAR(signed_volume(good.mesh), signed_volume(icosphere(3)) * 7 / 8, 1e-5);
  Checked turned = check(joined(icosphere(3), icosphere(3, 0.5f)));
  EXPECT_TRUE(mentions(turned, "inside out"));
  EXPECT_NEAR(signed_volume(turned.mesh), signed_volume(good.mesh), 1e-9);
  // A ball within the cavity is solid again.
  Checked nested = check(joined(shell, icosphere(2, 0.25f)));
  EXPECT_TRUE(nested.warnings.empty());
}

TEST(MeshCheck, OverlappingPartsAreNotCavities) {
  Checked result = check(joined(icosphere(3), transformed(icosphere(3, 0.5f), translation({0.9, 0.1, 0.2}))));
  EXPECT_TRUE(result.warnings.empty());
  EXPECT_NEAR(signed_volume(result.mesh), 9.0 / 8 * signed_volume(icosphere(3)), 1e-5);
}

TEST(MeshCheck, BoxesThatShareAnEdgeAreEven) {
  Checked result = check(joined(box({1, 1, 1}), transformed(box({1, 1, 1}), translation({1, 1, 0}))));
  EXPECT_TRUE(result.warnings.empty());
  EXPECT_NEAR(signed_volume(result.mesh), 2, 1e-6);
}

TEST(MeshCheck, RefusesWhatBoundsNoSolid) {
  EXPECT_NE(failure(quad(1, 1)).find("not closed"), std::string::npos);
  EXPECT_NE(failure(joined(quad(1, 1), flipped(transformed(quad(1, 1), rotation({0, 1, 0}, 90))))).find("no volume"),
            std::string::npos);
  EXPECT_NE(failure({{{0, 0, 0}, {1, 0, 0}}, {{0, 1, 0}}}).find("no area"), std::string::npos);
  Mesh fin = box({1, 1, 1});
  fin.positions.push_back({5, 5, 5});
  fin.triangles.push_back({0, 1, unsigned(fin.positions.size()) - 1});
  EXPECT_NE(failure(fin).find("not manifold"), std::string::npos) << failure(fin);
  Mesh band;  // of Moebius
  const int n = 20;
  for (int i = 0; i < n; ++i) {
    float angle = 6.2831853f * float(i) / n;
    glm::vec3 out(std::cos(angle), 0, std::sin(angle)),
        across = 0.2f * (std::cos(angle / 2) * out + std::sin(angle / 2) * glm::vec3(0, 1, 0));
    band.positions.push_back(out + across);
    band.positions.push_back(out - across);
  }
  for (unsigned i = 0; i < n; ++i) {
    unsigned a = 2 * i, b = 2 * i + 1, c = (2 * i + 2) % (2 * n), d = (2 * i + 3) % (2 * n);
    if (i == n - 1) std::swap(c, d);
    band.triangles.push_back({a, b, c});
    band.triangles.push_back({b, d, c});
  }
  EXPECT_NE(failure(band).find("one-sided"), std::string::npos) << failure(band);
}

TEST(Inside, SphereTorusAndCavity) {
  MeshRays ball(icosphere(4));
  EXPECT_TRUE(ball.inside({0, 0, 0}));
  EXPECT_TRUE(ball.inside({0.99f, 0, 0}));
  EXPECT_FALSE(ball.inside({1.01f, 0, 0}));
  EXPECT_FALSE(ball.inside({100, 3, 0}));
  EXPECT_FALSE(inside(torus(1, 0.3f, 64, 32), {0, 0, 0}));
  EXPECT_TRUE(inside(torus(1, 0.3f, 64, 32), {0, 0, 1}));
  EXPECT_FALSE(inside(joined(icosphere(3), flipped(icosphere(3, 0.5f))), {0.1f, 0.1f, 0}));
  EXPECT_TRUE(inside(box({1, 1, 1}), {0, 0, 0}));  // rays through the diagonals of faces
}

}  // namespace
}  // namespace alabaster

// The double-precision cut cells against what is known of the meshes: volumes, areas, closed surfaces, edge cases.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "domain/cut_cells.h"
#include "scene/error.h"
#include "scene/shapes.h"

namespace alabaster {
namespace {

/// A frame of unit cells with whole-number corners, so that shapes can be laid exactly on grid planes.
GridFrame unit_frame(glm::ivec3 cells) { return {cells, 1.0f, glm::vec3(0)}; }

Mesh box_between(glm::vec3 low, glm::vec3 high) {
  return transformed(box(high - low), translation(0.5 * glm::dvec3(low + high)));
}

/// What must hold for every closed mesh that does not overlap itself: exact volume and area, a closed surface in the
/// whole and in each cell, and values within their ranges.
void expect_consistent(const Mesh& mesh, const CutCells& cuts, double tolerance) {
  double h = cuts.frame.h;
  EXPECT_LT(cuts.worst_closure, 1e-9);
  EXPECT_NEAR(cuts.total_volume() / signed_volume(mesh), 1, tolerance);
  EXPECT_NEAR(cuts.total_area() / area(mesh), 1, tolerance);
  EXPECT_LT(glm::length(cuts.area_vector()), 1e-5 * area(mesh));
  for (const CutCell& c : cuts.cut_cells) {
    glm::dvec3 open{0};
    for (int i = 0; i < 3; ++i) {
      glm::ivec3 next = c.cell;
      ++next[i];
      double low = cuts.aperture[i][cuts.index(c.cell)], high = cuts.aperture[i][cuts.index(next)];
      EXPECT_GE(low, 0);
      EXPECT_LE(low, 1);
      open[i] = high - low;
      EXPECT_GE(c.centroid[i], -1e-9);
      EXPECT_LE(c.centroid[i], 1 + 1e-9);
    }
    EXPECT_LT(glm::length(open + c.facet.area_vector), 5e-5) << c.cell.x << ' ' << c.cell.y << ' ' << c.cell.z;
    EXPECT_GT(c.volume, 0);
    EXPECT_LT(c.volume, 1 + 1e-5);
    EXPECT_GE(c.facet.distance, 0);
    EXPECT_NEAR(c.side[0].area + c.side[1].area, c.facet.area, 1e-6);
  }
  EXPECT_GT(h, 0);
}

TEST(CutCells, SphereHasTheMeshVolumeAndArea) {
  Mesh mesh = icosphere(4, 0.7f);
  for (int n : {8, 20, 48}) expect_consistent(mesh, cut_cells(mesh, choose_frame(bounds_of(mesh), n)), 1e-5);
}

TEST(CutCells, TorusHasTheMeshVolumeAndArea) {
  Mesh mesh = transformed(torus(1.0f, 0.3f, 60, 24), rotation({1, 2, 3}, 37));
  for (int n : {16, 40}) expect_consistent(mesh, cut_cells(mesh, choose_frame(bounds_of(mesh), n)), 1e-5);
}

TEST(CutCells, RotatedBoxesHaveTheMeshVolumeAndArea) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int trial = 0; trial < 10; ++trial) {
    Mesh mesh = transformed(box({0.4 + unit(random), 0.4 + unit(random), 0.4 + unit(random)}),
                            rotation({unit(random) - 0.5, unit(random) - 0.5, unit(random)}, 360 * unit(random)));
    expect_consistent(mesh, cut_cells(mesh, choose_frame(bounds_of(mesh), 24)), 1e-5);
  }
}

TEST(CutCells, BoxOnGridPlanesHasWholeCellsOnly) {
  Mesh mesh = box_between({2, 3, 2}, {6, 5, 5});
  CutCells cuts = cut_cells(mesh, unit_frame({8, 8, 8}));
  expect_consistent(mesh, cuts, 1e-12);
  EXPECT_EQ(cuts.cut_cells.size(), 4u * 2 * 3);  // all 24 cells but none outside: the block is 2 cells thick
  for (const CutCell& c : cuts.cut_cells) EXPECT_NEAR(c.volume, 1, 1e-12);
  const CutCell* c = cuts.find({3, 4, 3});  // touches only the upper y face
  ASSERT_NE(c, nullptr);
  EXPECT_NEAR(c->facet.distance, 0.5, 1e-12);
  EXPECT_NEAR(c->facet.centroid.y, 1, 1e-12);
  EXPECT_EQ(cuts.aperture[1][cuts.index({3, 5, 3})], 0);
  EXPECT_EQ(cuts.aperture[1][cuts.index({3, 4, 3})], 1);
}

TEST(CutCells, HalfCellBoxHasKnownCellValues) {
  CutCells cuts = cut_cells(box_between({2, 2, 2}, {5, 5, 4.25f}), unit_frame({8, 8, 8}));
  const CutCell* c = cuts.find({3, 3, 4});
  ASSERT_NE(c, nullptr);
  EXPECT_NEAR(c->volume, 0.25, 1e-12);
  EXPECT_NEAR(c->centroid.z, 0.125, 1e-12);
  EXPECT_NEAR(c->centroid.x, 0.5, 1e-12);
  EXPECT_NEAR(c->facet.area, 1, 1e-12);
  EXPECT_NEAR(c->facet.distance, 0.125, 1e-12);
  EXPECT_NEAR(cuts.aperture[0][cuts.index({3, 3, 4})], 0.25, 1e-12);
  EXPECT_NEAR(c->low_face_centroid[0].z, 0.125, 1e-12);
  EXPECT_NEAR(c->low_face_centroid[0].y, 0.5, 1e-12);
  EXPECT_NEAR(c->low_face_centroid[1].z, 0.125, 1e-12);
  EXPECT_NEAR(c->low_face_centroid[2].x, 0.5, 1e-12);
}

TEST(CutCells, VertexOnNodeAndEdgeOnGridLine) {
  Mesh octahedron;  // vertices on grid nodes, edges in grid planes
  octahedron.positions = {{7, 4, 4}, {1, 4, 4}, {4, 7, 4}, {4, 1, 4}, {4, 4, 7}, {4, 4, 1}};
  octahedron.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  expect_consistent(octahedron, cut_cells(octahedron, unit_frame({8, 8, 8})), 1e-12);
  Mesh wedge;  // an edge runs along a grid line, two faces lie in grid planes
  wedge.positions = {{2, 2, 2}, {6, 2, 2}, {2, 5, 2}, {6, 5, 2}, {2, 2, 6}, {6, 2, 6}};
  wedge.triangles = {{0, 2, 3}, {0, 3, 1}, {0, 1, 5}, {0, 5, 4}, {2, 4, 5}, {2, 5, 3}, {0, 4, 2}, {1, 3, 5}};
  expect_consistent(wedge, cut_cells(wedge, unit_frame({8, 8, 8})), 1e-12);
}

TEST(CutCells, HugeAndTinyTrianglesAndSlivers) {
  Mesh huge = transformed(box({1, 1, 1}), rotation({3, 1, 2}, 50));
  expect_consistent(huge, cut_cells(huge, choose_frame(bounds_of(huge), 96)), 1e-5);
  Mesh tiny = icosphere(5, 1);  // about a hundred triangles a cell
  expect_consistent(tiny, cut_cells(tiny, choose_frame(bounds_of(tiny), 8)), 1e-5);
  Mesh slivers = transformed(cylinder(0.2f, 1.0f, 400), rotation({1, 0, 1}, 33));  // 1.0 long, 0.003 wide
  expect_consistent(slivers, cut_cells(slivers, choose_frame(bounds_of(slivers), 32)), 1e-5);
}

TEST(CutCells, PlateThinnerThanACellKeepsVolumeAreaAndThickness) {
  Mesh mesh = transformed(box({1, 0.008f, 1}), rotation({1, 0.3, 0.2}, 3));
  CutCells cuts = cut_cells(mesh, choose_frame(bounds_of(mesh), 32));  // 0.24 cells thick
  expect_consistent(mesh, cuts, 1e-4);
  EXPECT_EQ(cuts.slit_cells, 0);
  int plates = 0;
  for (const CutCell& c : cuts.cut_cells) {
    if (std::abs(c.side[0].area - c.side[1].area) > 1e-3 || c.facet.area < 1.9) continue;
    ++plates;
    EXPECT_NEAR(c.facet.distance, 0.5 * 0.008 / cuts.frame.h, 0.02);
    EXPECT_LT(glm::length(c.side[0].area_vector + c.side[1].area_vector), 1e-3);  // two sheets, back to back
    for (const Facet& sheet : c.side) EXPECT_NEAR(sheet.distance, 0.5 * 0.008 / cuts.frame.h, 0.02);
  }
  EXPECT_GT(plates, 300);
}

TEST(CutCells, NeedleKeepsVolumeAndArea) {
  Mesh mesh = transformed(cylinder(0.006f, 1.0f, 12), rotation({0.2, 0.4, 1}, 40));
  CutCells cuts = cut_cells(mesh, choose_frame(bounds_of(mesh), 32));
  expect_consistent(mesh, cuts, 1e-4);
  EXPECT_EQ(cuts.inner_cells(), 0u);
}

/// Cells that can be reached from `start` through open faces.
std::vector<char> reached(const CutCells& cuts, glm::ivec3 start) {
  std::vector<char> seen(cuts.volume.size(), 0);
  std::vector<glm::ivec3> todo{start};
  seen[cuts.index(start)] = 1;
  while (!todo.empty()) {
    glm::ivec3 cell = todo.back();
    todo.pop_back();
    for (int axis = 0; axis < 3; ++axis) {
      for (int side : {-1, 1}) {
        glm::ivec3 next = cell;
        next[axis] += side;
        glm::ivec3 upper = side > 0 ? next : cell;
        if (cuts.aperture[axis][cuts.index(upper)] <= 0 || seen[cuts.index(next)]) continue;
        seen[cuts.index(next)] = 1;
        todo.push_back(next);
      }
    }
  }
  return seen;
}

TEST(CutCells, SlitThinnerThanACellDoesNotLeak) {
  for (int axis = 0; axis < 3; ++axis) {
    for (float at : {5.1f, 5.35f, 5.6f}) {  // a slit of 0.3 cells within cell 5
      glm::vec3 low{2.25f}, high{9.75f}, left_high = high, right_low = low;
      left_high[axis] = at;
      right_low[axis] = at + 0.3f;
      Mesh mesh = joined(box_between(low, left_high), box_between(right_low, high));
      CutCells cuts = cut_cells(mesh, unit_frame({12, 12, 12}));
      EXPECT_NEAR(cuts.total_volume() / signed_volume(mesh), 1, 1e-5);
      EXPECT_NEAR(cuts.total_area() / area(mesh), 1, 1e-5);
      EXPECT_GT(cuts.slit_cells, 36);
      std::vector<char> seen = reached(cuts, {3, 3, 3});
      glm::ivec3 other{8};
      EXPECT_TRUE(seen[cuts.index({3, 3, 3})]);
      EXPECT_FALSE(seen[cuts.index(other)]) << "axis " << axis << ", slit at " << at;
      double left = 0, exact = signed_volume(box_between(low, left_high));
      for (std::size_t c = 0; c < seen.size(); ++c) left += seen[c] ? cuts.volume[c] : 0;
      EXPECT_NEAR(left / exact, 1, 1e-4);
    }
  }
}

/// Steady conduction (unit conductance a face) from the cells more than 5 cells to the left of the plane through the
/// grid's middle with normal n, to those as far to its right: what flows, by overrelaxed Gauss-Seidel.
double conducted(const CutCells& cuts, glm::dvec3 n) {
  glm::ivec3 cells = cuts.frame.cells;
  std::vector<double> phi(cuts.volume.size(), 0.5);
  std::vector<char> held(phi.size(), 0);
  for (std::size_t at = 0; at < phi.size(); ++at) {
    glm::dvec3 cell(at % cells.x, at / cells.x % cells.y, at / (cells.x * cells.y));
    double side = glm::dot(cell + 0.5 - 0.5 * glm::dvec3(cells), n);
    held[at] = std::abs(side) > 5 || cuts.volume[at] <= 0;
    if (std::abs(side) > 5) phi[at] = side < 0 ? 1 : 0;
  }
  const std::size_t stride[] = {1, std::size_t(cells.x), std::size_t(cells.x) * cells.y};
  auto inflow = [&](std::size_t at, double& open) {
    double flow = open = 0;
    for (int i = 0; i < 3; ++i) {
      double low = cuts.aperture[i][at], high = cuts.aperture[i][at + stride[i]];
      open += low + high;
      flow += (low > 0 ? low * phi[at - stride[i]] : 0) + (high > 0 ? high * phi[at + stride[i]] : 0);
    }
    return flow - open * phi[at];
  };
  double open = 0;
  for (int sweep = 0; sweep < 300; ++sweep) {
    for (std::size_t at = 0; at < phi.size(); ++at) {
      if (held[at]) continue;
      double flow = inflow(at, open);
      if (open > 0) phi[at] += 1.7 * flow / open;
    }
  }
  double sum = 0;
  for (std::size_t at = 0; at < phi.size(); ++at) {
    if (held[at] && cuts.volume[at] > 0 && phi[at] == 1) sum -= inflow(at, open);
  }
  return sum;
}

TEST(CutCells, TiltedSlitThinnerThanACellConductsNothing) {
  for (double angle : {3.0, 15.0, 30.0, 45.0}) {
    for (double gap : {0.1, 0.3, 0.8}) {
      glm::dmat4 turn = translation({18.13, 18.37, 18.21}) * rotation({0, 0.3, 1}, angle);
      auto block = [&](double from, double to) {
        return transformed(box({to - from, 14, 14}), turn * translation({0.5 * (from + to), 0, 0}));
      };
      Mesh slit = joined(block(-8, -gap / 2), block(gap / 2, 8));
      CutCells cuts = cut_cells(slit, unit_frame({36, 36, 36}));
      EXPECT_NEAR(cuts.total_volume() / signed_volume(slit), 1, 1e-5);
      EXPECT_NEAR(cuts.total_area() / area(slit), 1, 1e-5);
      EXPECT_GT(cuts.slit_cells, 20);
      glm::dvec3 n(turn * glm::dvec4(1, 0, 0, 0));
      double whole = conducted(cut_cells(block(-8, 8), unit_frame({36, 36, 36})), n);
      EXPECT_GT(whole, 10);
      EXPECT_LT(conducted(cuts, n) / whole, 1e-3) << angle << " degrees, gap " << gap;
    }
  }
}

TEST(CutCells, OpenMeshIsSeen) {
  Mesh mesh = icosphere(3, 1);
  mesh.triangles.pop_back();
  EXPECT_GT(cut_cells(mesh, choose_frame(bounds_of(mesh), 16)).worst_closure, 1e-4);
}

TEST(GridFrame, HoldsTheBoundsWithItsMargin) {
  for (int n : {8, 33, 64, 128}) {
    Bounds bounds;
    bounds.add({-1, 2, 0.5f});
    bounds.add({0.3f, 2.2f, 4});
    for (int alignment : {4, 16}) {
      GridFrame frame = choose_frame(bounds, n, alignment);
      EXPECT_EQ(frame.cells.x % alignment, 0);
      EXPECT_NEAR(frame.cells.z, n, 1);
      glm::vec3 low = (bounds.low - frame.origin) / frame.h,
                high = glm::vec3(frame.cells) - (bounds.high - frame.origin) / frame.h;
      for (int i = 0; i < 3; ++i) {
        EXPECT_GT(low[i], 1.2f);
        EXPECT_GT(high[i], 1.2f);
      }
    }
  }
}

TEST(GridFrame, RefusesWhatItCannotHold) {
  Bounds unit;
  unit.add(glm::vec3(0)), unit.add(glm::vec3(1));
  EXPECT_THROW(choose_frame(unit, 0), UserError);
  EXPECT_THROW(choose_frame(unit, 100000), UserError);
  EXPECT_THROW(choose_frame(Bounds{}, 32), UserError);
  EXPECT_THROW(cut_cells(icosphere(1, 9), choose_frame(unit, 16)), UserError);
}

}  // namespace
}  // namespace alabaster

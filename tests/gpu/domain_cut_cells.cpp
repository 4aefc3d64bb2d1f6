// The cut cells of the device against their double-precision twin: every field of every cell, on generated meshes and
// on edge cases; the tiles; what it refuses.
#include <cmath>
#include <numeric>
#include <random>

#include "domain/cut_cells.h"
#include "domain/domain.h"
#include "scene/error.h"
#include "scene/shapes.h"
#include "support/device.h"

namespace alabaster {
namespace {

constexpr double tolerance = 2e-5;  // cell units; apertures snap within 1e-5, sums are rounded to 6e-8 each

GridFrame unit_frame(glm::ivec3 cells) { return {cells, 1.0f, glm::vec3(0)}; }

Mesh box_between(glm::vec3 low, glm::vec3 high) {
  return transformed(box(high - low), translation(0.5 * glm::dvec3(low + high)));
}

/// A closed, bumpy, curved stand-in for scanned meshes.
Mesh bumpy(int subdivisions) {
  Mesh mesh = icosphere(subdivisions, 1);
  for (glm::vec3& p : mesh.positions) {
    p *= 1 + 0.12f * std::sin(7 * p.x + 1) * std::cos(9 * p.y) + 0.08f * std::sin(17 * p.z + 3 * p.x);
  }
  return mesh;
}

/// Worst differences, each weighted by the measure it belongs to (a centroid by its volume, and so on), in cell units.
struct Differences {
  double volume = 0, aperture = 0, area = 0, centroid = 0, facet_centroid = 0, distance = 0, face_centroid = 0,
         side = 0;
  double worst() const {
    return std::max({volume, aperture, area, centroid, facet_centroid, distance, face_centroid, side});
  }
};

void raise(double& worst, double value) {
  if (!(value <= worst)) worst = value;
}
double gap(glm::vec3 a, glm::dvec3 b) { return glm::length(glm::dvec3(a) - b); }

class DomainTest : public GpuTest {
 protected:
  DomainMaker maker{context};

  Differences compare(const Domain& domain, const CutCells& twin) {
    Differences d;
    std::vector<float> volume = gpu::download<float>(context, domain.volume);
    std::vector<float> aperture[3];
    for (int i = 0; i < 3; ++i) aperture[i] = gpu::download<float>(context, domain.aperture[i]);
    std::vector<std::uint32_t> index = gpu::download<std::uint32_t>(context, domain.cut_index);
    std::vector<GpuCutCell> cuts = gpu::download<GpuCutCell>(context, domain.cut_cells);
    EXPECT_EQ(cuts.size(), domain.summary.cut_cells + 1);
    EXPECT_EQ(volume.size(), twin.volume.size());
    for (std::size_t at = 0; at < volume.size(); ++at) {
      raise(d.volume, std::abs(volume[at] - twin.volume[at]));
      for (int i = 0; i < 3; ++i) raise(d.aperture, std::abs(aperture[i][at] - twin.aperture[i][at]));
      const CutCell* b = twin.cut_index[at] < 0 ? nullptr : &twin.cut_cells[twin.cut_index[at]];
      if (index[at] != 0 && b) {
        compare_cell(cuts[index[at]], *b, d);
        for (int i = 0; i < 3; ++i) {
          raise(d.face_centroid,
                twin.aperture[i][at] * gap(cuts[index[at]].low_face_centre[i], b->low_face_centroid[i]));
        }
      } else if (b) {
        raise(d.area, b->facet.area);  // it may only miss slivers
      } else if (index[at] != 0) {
        raise(d.area, cuts[index[at]].facet.area);
      }
    }
    return d;
  }

  static void compare_cell(const GpuCutCell& a, const CutCell& b, Differences& d) {
    EXPECT_EQ(a.cell, b.cell);
    raise(d.area, std::abs(a.facet.area - b.facet.area));
    raise(d.area, gap(a.facet.area_vector, b.facet.area_vector));
    if (b.volume > 1e-4) raise(d.centroid, b.volume * gap(a.centre, b.centroid));
    raise(d.facet_centroid, b.facet.area * gap(a.facet.centre, b.facet.centroid));
    if (b.volume > 1e-4) raise(d.distance, b.volume * b.facet.area * std::abs(a.facet.distance - b.facet.distance));
    for (int s = 0; s < 2; ++s) {
      raise(d.side, std::abs(a.side[s].area - b.side[s].area));
      raise(d.side, gap(a.side[s].area_vector, b.side[s].area_vector));
      raise(d.side, b.side[s].area * gap(a.side[s].centre, b.side[s].centroid));
    }
  }

  Domain expect_twin(const Mesh& mesh, const GridFrame& frame, const char* what, double exactness = 1e-5) {
    Domain domain = maker.make(mesh, frame);
    CutCells twin = cut_cells(mesh, frame);
    Differences d = compare(domain, twin);
    EXPECT_LT(d.worst(), tolerance) << what << ": volume " << d.volume << ", aperture " << d.aperture << ", area "
                                    << d.area << ", centroid " << d.centroid << ", facet centroid " << d.facet_centroid
                                    << ", distance " << d.distance << ", face centroid " << d.face_centroid << ", side "
                                    << d.side;
    const DomainSummary& s = domain.summary;
    EXPECT_EQ(s.inner_cells, twin.inner_cells()) << what;
    EXPECT_EQ(s.slit_cells, static_cast<std::uint32_t>(twin.slit_cells)) << what;
    EXPECT_NEAR(s.volume / signed_volume(mesh), 1, exactness) << what;
    EXPECT_NEAR(s.area / area(mesh), 1, exactness) << what;
    EXPECT_LT(glm::length(s.area_vector), 1e-5 * area(mesh)) << what;
    EXPECT_LT(s.worst_closure, 1e-5) << what;
    return domain;
  }
  Domain expect_twin(const Mesh& mesh, int n, const char* what, double exactness = 1e-5) {
    return expect_twin(mesh, choose_frame(bounds_of(mesh), n), what, exactness);
  }
};

TEST_F(DomainTest, SpheresAndTori) {
  for (int n : {8, 21, 40}) expect_twin(icosphere(4, 0.7f), n, "sphere");
  expect_twin(transformed(torus(1.0f, 0.3f, 60, 24), rotation({1, 2, 3}, 37)), 32, "torus");
}

TEST_F(DomainTest, RandomBoxes) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int trial = 0; trial < 8; ++trial) {
    Mesh mesh = transformed(box({0.4 + unit(random), 0.4 + unit(random), 0.4 + unit(random)}),
                            rotation({unit(random) - 0.5, unit(random) - 0.5, unit(random)}, 360 * unit(random)));
    expect_twin(mesh, 24, "box");
  }
}

TEST_F(DomainTest, BumpyMesh) { expect_twin(bumpy(5), 48, "bumpy"); }

TEST_F(DomainTest, AlignedBoxes) {
  expect_twin(box_between({2, 3, 2}, {6, 5, 5}), unit_frame({8, 8, 8}), "on grid planes");
  expect_twin(box_between({2, 2, 2}, {5, 5, 4.25f}), unit_frame({8, 8, 8}), "a quarter cell");
  expect_twin(box({1, 1, 1}), 20, "cube");
  expect_twin(box_between({1, 1, 1}, {7, 7, 7}), unit_frame({8, 8, 8}), "up to the margin");
}

TEST_F(DomainTest, VertexOnNodeAndEdgeOnGridLine) {
  Mesh octahedron;
  octahedron.positions = {{7, 4, 4}, {1, 4, 4}, {4, 7, 4}, {4, 1, 4}, {4, 4, 7}, {4, 4, 1}};
  octahedron.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  expect_twin(octahedron, unit_frame({8, 8, 8}), "octahedron");
  Mesh wedge;
  wedge.positions = {{2, 2, 2}, {6, 2, 2}, {2, 5, 2}, {6, 5, 2}, {2, 2, 6}, {6, 2, 6}};
  wedge.triangles = {{0, 2, 3}, {0, 3, 1}, {0, 1, 5}, {0, 5, 4}, {2, 4, 5}, {2, 5, 3}, {0, 4, 2}, {1, 3, 5}};
  expect_twin(wedge, unit_frame({8, 8, 8}), "wedge");
}

TEST_F(DomainTest, HugeAndTinyTrianglesAndSlivers) {
  expect_twin(transformed(box({1, 1, 1}), rotation({3, 1, 2}, 50)), 64, "huge");
  expect_twin(icosphere(5, 1), 8, "tiny");
  expect_twin(transformed(cylinder(0.2f, 1.0f, 400), rotation({1, 0, 1}, 33)), 32, "slivers");
}

TEST_F(DomainTest, ThinPartsKeepTheirVolumeAndArea) {
  expect_twin(transformed(box({1, 0.008f, 1}), rotation({1, 0.3, 0.2}, 3)), 32, "plate", 1e-4);
  expect_twin(transformed(box({1, 0.008f, 1}), rotation({1, 0.3, 0.2}, 31)), 32, "tilted plate", 1e-4);
  expect_twin(transformed(cylinder(0.006f, 1.0f, 12), rotation({0.2, 0.4, 1}, 40)), 32, "needle", 1e-4);
}

TEST_F(DomainTest, SlitsArePartedAsInTheTwin) {
  for (int axis = 0; axis < 3; ++axis) {
    for (float at : {5.1f, 5.6f}) {
      glm::vec3 low{2.25f}, high{9.75f}, left_high = high, right_low = low;
      left_high[axis] = at;
      right_low[axis] = at + 0.3f;
      Mesh mesh = joined(box_between(low, left_high), box_between(right_low, high));
      Domain domain = expect_twin(mesh, unit_frame({12, 12, 12}), "slit");
      EXPECT_GT(domain.summary.slit_cells, 36u);
      ASSERT_EQ(domain.warnings.size(), 1u);
      std::vector<float> open = gpu::download<float>(context, domain.aperture[axis]);
      glm::ivec3 face(6);  // one of the faces beside the slit is closed
      glm::ivec3 lower = face;
      lower[axis] = 5;
      auto index = [](glm::ivec3 c) { return c.x + 12 * (c.y + 12 * c.z); };
      EXPECT_EQ(std::min(open[index(face)], open[index(lower)]), 0);
    }
  }
}

TEST_F(DomainTest, TiltedSlitsArePartedAsInTheTwin) {
  for (double angle : {5.0, 28.0, 44.0}) {
    glm::dmat4 turn = translation({18.13, 18.37, 18.21}) * rotation({0.2, 0.3, 1}, angle);
    auto block = [&](double from, double to) {
      return transformed(box({to - from, 14, 14}), turn * translation({0.5 * (from + to), 0, 0}));
    };
    Domain domain = expect_twin(joined(block(-8, -0.15), block(0.15, 8)), unit_frame({36, 36, 36}), "tilted slit");
    EXPECT_GT(domain.summary.slit_cells, 150u);
  }
}

TEST_F(DomainTest, IsTheSameTwice) {
  Mesh mesh = bumpy(4);
  GridFrame frame = choose_frame(bounds_of(mesh), 32);
  Domain a = maker.make(mesh, frame), b = maker.make(mesh, frame);
  EXPECT_EQ(gpu::download<float>(context, a.volume), gpu::download<float>(context, b.volume));
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(gpu::download<float>(context, a.aperture[i]), gpu::download<float>(context, b.aperture[i]));
  }
  EXPECT_EQ(gpu::download<std::uint32_t>(context, a.cut_cells), gpu::download<std::uint32_t>(context, b.cut_cells));
  EXPECT_EQ(gpu::download<std::uint32_t>(context, a.cut_index), gpu::download<std::uint32_t>(context, b.cut_index));
}

TEST_F(DomainTest, CavitiesCountAndOverlapsAreSaid) {
  Mesh hollow = joined(icosphere(4, 1), flipped(icosphere(3, 0.5f)));
  EXPECT_TRUE(expect_twin(hollow, 32, "hollow sphere").warnings.empty());
  Mesh overlapping = joined(box({1, 1, 1}), transformed(box({1, 1, 1}), translation({0.4, 0.3, 0.2})));
  Domain domain = maker.make(overlapping, choose_frame(bounds_of(overlapping), 24));
  ASSERT_EQ(domain.warnings.size(), 1u);
  EXPECT_NE(domain.warnings[0].find("overlaps itself"), std::string::npos);
  for (float a : gpu::download<float>(context, domain.aperture[0])) EXPECT_LE(a, 1);
  for (float v : gpu::download<float>(context, domain.volume)) EXPECT_LE(v, 1 + 1e-5);
}

// As scanned meshes have them: a few triangles folded over, which a fine grid sees and a coarse one does not.
TEST_F(DomainTest, SmallFoldsAreLeftOutAndSaid) {
  const Mesh ball = icosphere(4, 1), fold = transformed(flipped(icosphere(2, 0.04f)), translation({1.2, 0, 0}));
  const Mesh folded = joined(ball, fold);
  const GridFrame frame = choose_frame(bounds_of(folded), 48);
  const Domain domain = maker.make(folded, frame), alone = maker.make(ball, frame);
  ASSERT_EQ(domain.warnings.size(), 1u);
  EXPECT_NE(domain.warnings[0].find("folded"), std::string::npos);
  for (float a : gpu::download<float>(context, domain.aperture[0])) EXPECT_GE(a, 0);
  const std::vector<float> volume = gpu::download<float>(context, domain.volume);
  for (float v : volume) EXPECT_GE(v, 0);
  const std::vector<float> unfolded = gpu::download<float>(context, alone.volume);
  EXPECT_NEAR(std::accumulate(volume.begin(), volume.end(), 0.0),
              std::accumulate(unfolded.begin(), unfolded.end(), 0.0), std::pow(0.08 / frame.h, 3))
      << "cells, of the fold's own box";
}

TEST_F(DomainTest, RefusesOpenInvertedAndEmptyMeshes) {
  Mesh open = icosphere(3, 1);
  open.triangles.pop_back();
  GridFrame frame = choose_frame(bounds_of(open), 16);
  EXPECT_THROW(maker.make(open, frame), UserError);
  EXPECT_THROW(maker.make(flipped(icosphere(3, 1)), frame), UserError);
  EXPECT_THROW(maker.make(Mesh{}, frame), UserError);
}

}  // namespace
}  // namespace alabaster

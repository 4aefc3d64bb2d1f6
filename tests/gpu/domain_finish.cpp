// The passes that make cut cells of the sums and part them at slits, one by one: finish, part.
#include <algorithm>
#include <cmath>

#include "support/device.h"
#include "support/domain_sets.h"

namespace alabaster {
namespace {

struct Part {  // of the surface: integrals n dA, dA, x dA, n.x dA
  glm::dvec3 A{0}, X{0};
  double S = 0, T = 0;
  void add(const Part& o, double sign, glm::dvec3 offset) {
    A += sign * o.A, S += sign * o.S, X += sign * (o.X + offset * o.S), T += sign * (o.T + glm::dot(offset, o.A));
  }
};

/// Random sums, gifts and faces of low faces; gifts stay inside the grid.
class DomainFinish : public GpuTest {
 protected:
  DomainFinish() {
    std::mt19937 engine(2);
    std::uniform_real_distribution<double> uniform(0, 1);
    gifts.assign(grid.list.size(), 0);
    for (std::size_t r = 0; r < gifts.size(); ++r) {
      const glm::ivec3 c = grid.cell(grid.list[r]);
      const bool inner =
          glm::all(glm::greaterThan(c, glm::ivec3(0))) && glm::all(glm::lessThan(c, grid.cells - glm::ivec3(1)));
      const int kind = int(6 * uniform(engine));
      const bool both = sums.of(r, kind, at_S) > 0 && sums.of(r, kind ^ 1, at_S) > 0;
      if (inner && both) gifts[r] = 1 + kind;
    }
    for (std::size_t i = 0; i < 3 * grid.list.size(); ++i) {
      const double a = i % 5 == 0 ? 0 : uniform(engine);
      faces.push_back(glm::ivec4(sums_one * a * glm::dvec4(1, uniform(engine), uniform(engine), uniform(engine))));
    }
    for (auto& a : apertures)
      for (std::size_t i = 0; i < grid.count(); ++i) a.push_back(i % 4 == 0 ? 0 : float(uniform(engine)));
  }

  Part part(std::size_t r, int kind) const {
    Part p;
    p.A = sums.three(r, kind, at_A), p.S = sums.of(r, kind, at_S), p.X = sums.three(r, kind, at_X);
    for (int i = 0; i < 3; ++i) p.T += sums.of(r, kind, at_M + 4 * i);
    return p;
  }
  gpu::Image aperture_image(int axis) {
    gpu::Image image = gpu::image3d(context, {grid.cells.x / 4, grid.cells.y, grid.cells.z},
                                    VK_FORMAT_R32G32B32A32_SFLOAT, "aperture");
    gpu::upload(context, image, apertures[axis]);
    return image;
  }
  GpuCutCell finished(glm::ivec3 cell, bool parted) const;

  CandidateGrid grid{{20, 16, 14}, 0.5, 3};
  SurfaceSums sums = random_sums(grid.list.size(), 4);
  std::vector<std::uint32_t> gifts;  // 1 + the class given, 0 for none
  std::vector<glm::ivec4> faces;
  std::vector<float> apertures[3];
};

/// The definitions of engine/domain/cut_cells.h, from the sums.
GpuCutCell DomainFinish::finished(glm::ivec3 cell, bool parted) const {
  const int rank = grid.rank(cell);
  double volume = 0, reach = 0;
  glm::dvec3 moment(0);
  Part sides[2];
  glm::dvec4 low[3];
  if (rank < 0) {
    volume = apertures[0][grid.at(cell)] > 0.5f;
    moment = glm::dvec3(0.5 * volume);
    for (glm::dvec4& f : low) f = volume * glm::dvec4(1, 0.5, 0.5, 0.5);
  } else {
    for (int kind = 0; kind < 6; ++kind) sides[kind % 2].add(part(rank, kind), 1, glm::dvec3(0));
    for (int i = 0; i < 3; ++i) {
      double A = 0, M = 0, Q = 0;
      for (int kind = 0; kind < 6; ++kind)
        A += sums.of(rank, kind, at_A + i), M += sums.of(rank, kind, at_M + 4 * i), Q += sums.of(rank, kind, at_Q + i);
      low[i] = glm::dvec4(faces[3 * rank + i]) / sums_one;
      volume += (low[i].x - A + M) / 3;
      moment[i] = 0.5 * (low[i].x - A) + Q;
    }
  }
  // What cell r gives of class `kind`: a sheet and the piece between it and the face it goes through.
  const auto move = [&](std::size_t r, int kind, double sign, glm::dvec3 offset) {
    const int i = kind / 2;
    const double high = kind % 2 ? sums.of(r, kind, at_A + i) : 0;
    const double piece = std::max(0.0, sums.of(r, kind, at_M + 4 * i) - high);
    glm::dvec3 m = piece * sums.three(r, kind, at_X) / sums.of(r, kind, at_S);
    m[i] = sums.of(r, kind, at_Q + i) - 0.5 * high;
    volume += sign * piece;
    moment += sign * (m + offset * piece);
    sides[kind % 2].add(part(r, kind), sign, offset);
  };
  const auto close = [&](std::size_t r, int kind) {
    const int i = kind / 2;
    const double sign = kind % 2 ? -1 : 1;
    low[i] -= sign * glm::dvec4(sums.of(r, kind, at_A + i), sums.three(r, kind, at_M + 3 * i));
  };
  if (parted && rank >= 0 && gifts[rank] != 0) {
    const int kind = int(gifts[rank]) - 1;
    move(rank, kind, -1, glm::dvec3(0));
    if (kind % 2 == 0) close(rank, kind);
  }
  for (int kind = 0; parted && kind < 6; ++kind) {
    const int toward = kind % 2 ? 1 : -1;
    glm::ivec3 from = cell;
    from[kind / 2] -= toward;
    const int other = grid.rank(from);
    if (other < 0 || gifts[other] != std::uint32_t(kind + 1)) continue;
    glm::dvec3 offset(0);
    offset[kind / 2] = -toward;
    move(other, kind, 1, offset);
    reach = 1;
    if (toward == 1) close(other, kind);
  }
  Part all = sides[0];
  all.add(sides[1], 1, glm::dvec3(0));
  glm::dvec3 centre = volume > 1e-6 ? moment / volume : all.X / std::max(all.S, 1e-7);
  centre = glm::clamp(centre, glm::dvec3(-reach), glm::dvec3(1 + reach));
  const auto facet = [&](const Part& p) {
    GpuFacet f{};
    if (p.S < 1e-7) return f;
    f.area = float(p.S), f.area_vector = glm::vec3(p.A), f.centre = glm::vec3(p.X / p.S);
    f.distance = float(std::max(0.0, (p.T - glm::dot(p.A, centre)) / p.S));
    return f;
  };
  GpuCutCell cut{};
  cut.cell = cell;
  cut.volume = float(std::clamp(volume, 1e-6, 1 + 6 * reach));
  cut.centre = glm::vec3(centre);
  cut.facet = facet(all);
  for (int s = 0; s < 2; ++s) cut.side[s] = facet(sides[s]);
  for (int i = 0; i < 3; ++i) {
    glm::dvec3 c =
        low[i].x < 1e-5 ? glm::dvec3(0.5) : glm::clamp(glm::dvec3(low[i].y, low[i].z, low[i].w) / low[i].x, 0.0, 1.0);
    c[i] = 0;
    cut.low_face_centre[i] = glm::vec3(c);
  }
  return cut;
}

double apart(const GpuFacet& a, const GpuFacet& b) {
  // centroid and depth weigh as much as the area they belong to
  return std::max({double(std::abs(a.area - b.area)), double(glm::length(a.area_vector - b.area_vector)),
                   double(b.area * glm::length(a.centre - b.centre)),
                   double(b.area * std::abs(a.distance - b.distance))});
}

TEST_F(DomainFinish, FinishEqualsTwin) {
  for (int parted : {0, 1}) {
    const gpu::Pass finish(context, "domain/finish.comp", {parted});
    std::vector<std::uint32_t> list;  // with surface, and takers
    for (std::size_t i = 0; i < grid.count(); ++i) {
      bool listed = grid.rank_of[i] >= 0;
      for (int kind = 0; kind < 6 && !listed && parted; ++kind) {
        glm::ivec3 from = grid.cell(i);
        from[kind / 2] -= kind % 2 ? 1 : -1;
        listed = grid.rank(from) >= 0 && gifts[grid.rank(from)] == std::uint32_t(kind + 1);
      }
      if (listed) list.push_back(std::uint32_t(i));
    }
    const gpu::Buffer cells(context, (list.size() + 1) * sizeof(GpuCutCell), "cut cells");
    const gpu::Image aperture_x = aperture_image(0);
    Inputs input(context);
    gpu::Commands commands(context);
    commands.dispatch(finish, {list.size(), 1, 1},
                      {{"bits", input(grid.set.bits, "bits")},
                       {"before", input(grid.set.before(), "before")},
                       {"sums", input(sums.values, "sums")},
                       {"cut_list", input(list, "list")},
                       {"gifts", input(gifts, "gifts")},
                       {"faces", input(faces, "faces")},
                       {"cut_cells", cells},
                       {"aperture_x", aperture_x}},
                      grid.push(list.size()));
    commands.submit();
    const std::vector<GpuCutCell> got = gpu::download<GpuCutCell>(context, cells);
    int takers = 0, small = 0;
    for (std::size_t k = 0; k < list.size(); ++k) {
      const GpuCutCell expected = finished(grid.cell(list[k]), parted), &mine = got[k + 1];
      takers += grid.rank_of[list[k]] < 0;
      ASSERT_EQ(mine.cell, expected.cell);
      EXPECT_NEAR(mine.volume, expected.volume, 2e-6) << k;
      if (expected.volume < 1e-3) {  // moment / volume amplifies rounding without bound
        ++small;
        continue;
      }
      EXPECT_LT(glm::length(mine.centre - expected.centre), 1e-5 / expected.volume) << k;
      const double facet_rounding = 1e-5 / std::min(1.f, expected.volume);
      EXPECT_LT(apart(mine.facet, expected.facet), facet_rounding) << k;
      for (int s = 0; s < 2; ++s) EXPECT_LT(apart(mine.side[s], expected.side[s]), facet_rounding) << k;
      for (int i = 0; i < 3; ++i)
        EXPECT_LT(glm::length(mine.low_face_centre[i] - expected.low_face_centre[i]), 1e-4) << k << " " << i;
    }
    EXPECT_EQ(takers > 5, parted == 1);
    EXPECT_LT(small, int(list.size() / 2));
  }
}

TEST_F(DomainFinish, PartEqualsTwin) {
  const gpu::Pass part_pass(context, "domain/part.comp");
  const glm::ivec3 texels(grid.cells.x / 4, grid.cells.y, grid.cells.z);
  std::vector<std::uint32_t> list;
  for (std::uint32_t t = 0; t < grid.count() / 4; ++t)
    if (t % 5 != 2) list.push_back(t);  // not all: the others stay as they are
  const gpu::Image images[3] = {aperture_image(0), aperture_image(1), aperture_image(2)};
  Inputs input(context);
  gpu::Commands commands(context);
  commands.dispatch(part_pass, {list.size(), 1, 1},
                    {{"bits", input(grid.set.bits, "bits")},
                     {"before", input(grid.set.before(), "before")},
                     {"sums", input(sums.values, "sums")},
                     {"list", input(list, "list")},
                     {"gifts", input(gifts, "gifts")},
                     {"faces", input(faces, "faces")},
                     {"aperture_x", images[0]},
                     {"aperture_y", images[1]},
                     {"aperture_z", images[2]}},
                    grid.push(list.size()));
  commands.submit();
  const auto behind = [&](glm::dvec3 x, int r, int kind) {
    return glm::dot(x - sums.three(r, kind, at_X) / sums.of(r, kind, at_S), sums.three(r, kind, at_A));
  };
  int closed = 0, narrowed = 0, skipped = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<float> got = gpu::download<float>(context, images[axis]);
    for (std::size_t i = 0; i < got.size(); ++i) {
      const float open = apertures[axis][i];
      double expected = open;
      glm::ivec3 below = grid.cell(i);
      --below[axis];
      const int high = grid.rank_of[i], low = grid.rank(below);
      const int given_high = high >= 0 ? int(gifts[high]) - 1 : -1, given_low = low >= 0 ? int(gifts[low]) - 1 : -1;
      const bool listed = i / 4 % 5 != 2;
      bool shut = false;
      if (listed && given_high >= 0 && given_low >= 0) {  // two that keep opposite pieces are not joined
        shut = glm::dot(sums.three(high, given_high ^ 1, at_A), sums.three(low, given_low ^ 1, at_A)) < 0;
      } else if (listed && (given_high >= 0 || given_low >= 0)) {  // nor is one through a face of the piece given away
        glm::dvec3 centre(0.5);
        const glm::dvec4 face = high >= 0 ? glm::dvec4(faces[3 * high + axis]) : glm::dvec4(0);
        if (high >= 0 && open >= 1e-5f) centre = glm::dvec3(face.y, face.z, face.w) / face.x;
        if (!std::isfinite(centre.x)) {
          ++skipped;
          continue;
        }
        centre[axis] = given_high >= 0 ? 0 : 1;
        const int giver = given_high >= 0 ? high : low, gone = std::max(given_high, given_low);
        const double side_gone = behind(centre, giver, gone), side_kept = behind(centre, giver, gone ^ 1);
        if (std::min(std::abs(side_gone), std::abs(side_kept)) < 1e-5) {
          ++skipped;  // on the sheet: rounding decides
          continue;
        }
        shut = side_gone < 0 && !(side_kept < 0);
      }
      if (listed && shut) expected = 0, ++closed;
      if (listed && !shut && (given_high >= 0 || given_low >= 0)) {
        if (given_high == 2 * axis) expected -= std::abs(sums.of(high, 2 * axis, at_A + axis)), ++narrowed;
        if (given_low == 2 * axis + 1) expected -= std::abs(sums.of(low, 2 * axis + 1, at_A + axis)), ++narrowed;
        if (expected < 1e-5) expected = 0;
      }
      ASSERT_NEAR(got[i], expected, 2e-6) << axis << " " << i;
    }
  }
  EXPECT_GT(closed, 20);
  EXPECT_GT(narrowed, 5);
  EXPECT_LT(skipped, 200);
}

}  // namespace
}  // namespace alabaster

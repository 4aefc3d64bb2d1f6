// The passes between triangles and cut cells, one by one: accumulate, candidate, sweep, dense.
#include <algorithm>
#include <array>
#include <cmath>

#include "domain/cut_cells.h"
#include "support/device.h"
#include "support/domain_sets.h"

namespace alabaster {
namespace {

class DomainSums : public GpuTest {};

using Corners = std::vector<glm::dvec3>;

Corners clipped(const Corners& in, int axis, double plane, double sign) {
  Corners out;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const glm::dvec3 a = in[i], b = in[(i + 1) % in.size()];
    const double da = sign * (a[axis] - plane), db = sign * (b[axis] - plane);
    if (da <= 0) out.push_back(a);
    if (da * db < 0) out.push_back(a + (b - a) * (da / (da - db)));
  }
  return out;
}

TEST_F(DomainSums, AccumulateIntegratesOverThePieces) {
  const gpu::Pass accumulate(context, "domain/accumulate.comp");
  CandidateGrid grid({8, 8, 8}, 1, 1);
  std::mt19937 engine(9);
  std::uniform_real_distribution<float> uniform(0, 8);
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  std::vector<glm::uvec2> pairs;
  const auto add = [&](glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    const auto first = std::uint32_t(positions.size());
    for (glm::vec3 p : {a, b, c}) positions.push_back(p);
    triangles.push_back({first, first + 1, first + 2});
    for (std::uint32_t cell = 0; cell < grid.count(); ++cell) pairs.push_back({first / 3, cell});
  };
  for (int i = 0; i < 30; ++i) {
    const auto point = [&] { return glm::vec3(uniform(engine), uniform(engine), uniform(engine)); };
    const glm::vec3 a = point();
    const float size = i % 3 == 0 ? 0.05f : 1;
    add(a, glm::mix(a, point(), size), glm::mix(a, point(), size));
  }
  add({2, 2, 4}, {2, 6, 4.5f}, {6, 2, 3.5f});  // corners on nodes and grid lines
  add({1.25f, 1.5f, 2.5f}, {1.75f, 1.5f, 2.5f}, {1.25f, 1.75f, 2.5f});
  const gpu::Buffer sums =
      gpu::make_buffer(context, std::vector<std::int32_t>(grid.count() * 6 * sums_a_class), "sums");
  Inputs input(context);
  gpu::Commands commands(context);
  commands.dispatch(accumulate, {pairs.size(), 1, 1},
                    {{"positions", input(positions, "positions")},
                     {"triangles", input(triangles, "triangles")},
                     {"pairs", input(pairs, "pairs")},
                     {"bits", input(grid.set.bits, "bits")},
                     {"before", input(grid.set.before(), "before")},
                     {"sums", sums}},
                    grid.push(pairs.size()));
  commands.submit();
  std::vector<double> expected(grid.count() * 6 * sums_a_class, 0.0);
  for (std::size_t k = 0; k < triangles.size(); ++k)
    for (std::size_t i = 0; i < grid.count(); ++i) {
      Corners piece;
      for (int v = 0; v < 3; ++v) piece.push_back(glm::dvec3(positions[3 * k + v]) - glm::dvec3(grid.cell(i)));
      const glm::dvec3 normal = glm::normalize(glm::cross(piece[1] - piece[0], piece[2] - piece[0]));
      for (int axis = 0; axis < 3; ++axis) piece = clipped(clipped(piece, axis, 0, -1), axis, 1, 1);
      double* s = &expected[(6 * i + facet_class(normal)) * sums_a_class];
      for (std::size_t c = 2; c < piece.size(); ++c) {
        const glm::dvec3 a = piece[0], b = piece[c - 1], d = piece[c], A = 0.5 * glm::cross(b - a, d - a),
                         centre = (a + b + d) / 3.0;
        // integral of x_i^2 over a triangle by its edges' middles, exact for squares
        const glm::dvec3 squares =
            (0.25 * (a + b) * (a + b) + 0.25 * (b + d) * (b + d) + 0.25 * (d + a) * (d + a)) / 3.0;
        s[at_S] += glm::length(A);
        for (int x = 0; x < 3; ++x) {
          s[at_A + x] += A[x], s[at_X + x] += glm::length(A) * centre[x], s[at_Q + x] += 0.5 * A[x] * squares[x];
          for (int j = 0; j < 3; ++j) s[at_M + 3 * x + j] += A[x] * centre[j];
        }
      }
    }
  const std::vector<std::int32_t> got = gpu::download<std::int32_t>(context, sums);
  double worst = 0, most = 0;
  for (std::size_t i = 0; i < got.size(); ++i) {
    worst = std::max(worst, std::abs(got[i] / sums_one - expected[i]));
    most = std::max(most, std::abs(expected[i]));
  }
  EXPECT_GT(most, 1);
  EXPECT_LT(worst, 5e-6);
}

TEST_F(DomainSums, CandidateEqualsTwin) {
  const gpu::Pass candidate(context, "domain/candidate.comp");
  CandidateGrid grid({12, 9, 10}, 0, 1);
  for (std::size_t i = 0; i < grid.count(); ++i) {  // gifts go to neighbours: none at the margin
    const glm::ivec3 c = grid.cell(i);
    if (glm::all(glm::greaterThan(c, glm::ivec3(0))) && glm::all(glm::lessThan(c, grid.cells - 1)) && i % 3 != 1)
      grid.set.set(i);
  }
  grid = [&] {
    CandidateGrid made = grid;
    made.list = made.set.list();
    for (std::size_t r = 0; r < made.list.size(); ++r) made.rank_of[made.list[r]] = int(r);
    return made;
  }();
  const std::size_t count = grid.list.size();
  SurfaceSums sums = random_sums(count, 6);
  sums.values[(6 * 3 + 2) * sums_a_class + at_S] = std::int32_t(101 * sums_one);  // too much surface
  const auto words = [](std::size_t n) { return std::vector<std::uint32_t>((n + 31) / 32); };
  const gpu::Buffer gifts(context, count * 4, "gifts"), faces(context, count * 48, "faces"),
      cut_bits = gpu::make_buffer(context, words(grid.count()), "cut bits"),
      slit_bits = gpu::make_buffer(context, words(grid.count() / 4), "slit bits"),
      status = gpu::make_buffer(context, std::vector<DomainStatus>(1), "status");
  Inputs input(context);
  gpu::Commands commands(context);
  commands.dispatch(candidate, {count, 1, 1},
                    {{"bits", input(grid.set.bits, "bits")},
                     {"before", input(grid.set.before(), "before")},
                     {"sums", input(sums.values, "sums")},
                     {"list", input(grid.list, "list")},
                     {"gifts", gifts},
                     {"cut_bits", cut_bits},
                     {"slit_bits", slit_bits},
                     {"status", status},
                     {"faces", faces}},
                    grid.push(count));
  commands.submit();
  std::vector<std::uint32_t> expected_gifts(count, 0);
  std::vector<glm::ivec4> expected_faces(3 * count);
  Bits cut(grid.count()), slit(grid.count() / 4);
  std::uint32_t slits = 0;
  for (std::size_t r = 0; r < count; ++r) {
    double S = 0, widest = 2e-4;
    for (int kind = 0; kind < 6; ++kind) {
      S += sums.of(r, kind, at_S);
      for (int axis = 0; axis < 3; ++axis) {
        const std::int32_t* s = &sums.values[(6 * r + kind) * sums_a_class];
        const std::int32_t* m = s + at_M + 3 * axis;
        expected_faces[3 * r + axis] += glm::ivec4(s[at_A + axis], m[0], m[1], m[2]);
      }
    }
    if (S < 1e-7) continue;
    cut.set(grid.list[r]);
    for (int axis = 0; axis < 3; ++axis) {  // solid ends at one sheet and begins again at another further up
      const double end = sums.of(r, 2 * axis, at_A + axis), begin = -sums.of(r, 2 * axis + 1, at_A + axis);
      if (std::min(end, begin) <= widest) continue;
      const double end_at = sums.of(r, 2 * axis, at_M + 4 * axis) / end,
                   begin_at = -sums.of(r, 2 * axis + 1, at_M + 4 * axis) / begin;
      if (begin_at <= end_at) continue;
      widest = std::min(end, begin);
      expected_gifts[r] = 1 + 2 * axis + (end_at + begin_at > 1);
    }
    if (expected_gifts[r] == 0) continue;
    ++slits;
    const glm::ivec3 c = grid.cell(grid.list[r]);
    slit.set(grid.at(c) / 4);
    for (int axis = 0; axis < 3; ++axis) {
      glm::ivec3 up = c;
      ++up[axis];
      slit.set(grid.at(up) / 4);
    }
    glm::ivec3 taker = c;
    const int kind = int(expected_gifts[r]) - 1;
    taker[kind / 2] += kind % 2 ? 1 : -1;
    cut.set(grid.at(taker));
  }
  EXPECT_GT(slits, 20u);
  EXPECT_EQ(gpu::download<std::uint32_t>(context, gifts), expected_gifts);
  EXPECT_EQ(gpu::download<glm::ivec4>(context, faces), expected_faces);
  EXPECT_EQ(gpu::download<std::uint32_t>(context, cut_bits), cut.bits);
  EXPECT_EQ(gpu::download<std::uint32_t>(context, slit_bits), slit.bits);
  const DomainStatus got = gpu::download<DomainStatus>(context, status)[0];
  EXPECT_EQ(got.slit_cells, slits);
  EXPECT_EQ(got.crumpled_cells, 1u);
}

TEST_F(DomainSums, SweepIsARunningSumAlongItsAxis) {
  const CandidateGrid grid({20, 11, 9}, 0.3, 5);
  std::mt19937 engine(8);
  std::uniform_int_distribution<std::int32_t> any(-(1 << 24), 1 << 24);
  std::vector<glm::ivec4> faces(3 * grid.list.size());
  for (glm::ivec4& f : faces) f = {any(engine), any(engine), any(engine), any(engine)};
  const gpu::Buffer buffer = gpu::make_buffer(context, faces, "faces"),
                    bits = gpu::make_buffer(context, grid.set.bits, "bits"),
                    before = gpu::make_buffer(context, grid.set.before(), "before");
  std::vector<glm::ivec4> expected = faces;
  for (int axis = 0; axis < 3; ++axis) {
    const gpu::Pass sweep(context, "domain/sweep.comp", {axis});
    const glm::ivec3 texels(grid.cells.x / 4, grid.cells.y, grid.cells.z);
    const gpu::Image aperture = gpu::image3d(context, texels, VK_FORMAT_R32G32B32A32_SFLOAT, "aperture");
    const gpu::Buffer status = gpu::make_buffer(context, std::vector<DomainStatus>(1), "status");
    gpu::Commands commands(context);
    commands.dispatch(
        sweep, glm::uvec3(texels[axis == 0 ? 1 : 0], texels[axis == 2 ? 1 : 2], 1),
        {{"bits", bits}, {"before", before}, {"faces", buffer}, {"status", status}, {"aperture", aperture}},
        grid.push(0));
    commands.submit();
    const std::vector<float> open = gpu::download<float>(context, aperture);
    std::uint32_t closure = 0;
    for (std::size_t start = 0; start < grid.count(); ++start) {
      glm::ivec3 c = grid.cell(start);
      if (c[axis] != 0) continue;
      glm::ivec4 running(0);
      for (; c[axis] < grid.cells[axis]; ++c[axis]) {
        ASSERT_EQ(open[grid.at(c)], float(running.x) / float(sums_one)) << axis;
        if (grid.rank(c) < 0) continue;
        const std::size_t at = 3 * std::size_t(grid.rank(c)) + axis;
        const glm::ivec4 surface = expected[at];
        expected[at] = running;
        running -= surface;
      }
      closure = std::max(closure, std::uint32_t(std::abs(running.x)));
    }
    EXPECT_EQ(gpu::download<DomainStatus>(context, status)[0].closure, closure) << axis;
  }
  EXPECT_EQ(gpu::download<glm::ivec4>(context, buffer), expected);
}

TEST_F(DomainSums, DenseEqualsTwin) {
  const gpu::Pass dense(context, "domain/dense.comp");
  const CandidateGrid grid({36, 18, 5}, 0.2, 7);  // two tiles along x and y, the last ones not full
  std::mt19937 engine(12);
  std::uniform_real_distribution<float> uniform(-0.3f, 1.3f);
  std::vector<float> apertures[3];
  for (auto& a : apertures) {
    a.resize(grid.count());
    for (std::size_t i = 0; i < a.size(); ++i)
      a[i] = i % 3 == 0 ? 0 : i % 7 == 0 ? 1 - 5e-6f : i % 5 == 0 ? 5e-6f : uniform(engine);
  }
  for (std::size_t i = 0; i < grid.count(); ++i)  // a layer with nothing in it: no tile
    if (grid.cell(i).z == 2) apertures[0][i] = 0;
  CandidateGrid cut = grid;
  cut.set = Bits(grid.count());
  for (std::uint32_t i : grid.list)
    if (grid.cell(i).z != 2) cut.set.set(i);
  const std::vector<std::uint32_t> list = cut.set.list();
  std::vector<GpuCutCell> cells(list.size() + 1);
  for (GpuCutCell& c : cells) c.volume = 0.5f + 0.3f * uniform(engine);
  const glm::ivec3 texels(grid.cells.x / 4, grid.cells.y, grid.cells.z);
  gpu::Image images[3], volume = gpu::image3d(context, texels, VK_FORMAT_R32G32B32A32_SFLOAT, "volume"),
                        index = gpu::image3d(context, grid.cells, VK_FORMAT_R32_UINT, "cut index");
  for (int i = 0; i < 3; ++i) {
    images[i] = gpu::image3d(context, texels, VK_FORMAT_R32G32B32A32_SFLOAT, "aperture");
    gpu::upload(context, images[i], apertures[i]);
  }
  const gpu::Buffer status = gpu::make_buffer(context, std::vector<DomainStatus>(1), "status");
  Inputs input(context);
  gpu::Commands commands(context);
  commands.dispatch(dense, glm::uvec3(texels),
                    {{"cut_bits", input(cut.set.bits, "cut bits")},
                     {"cut_before", input(cut.set.before(), "before")},
                     {"cut_cells", input(cells, "cut cells")},
                     {"status", status},
                     {"aperture_x", images[0]},
                     {"aperture_y", images[1]},
                     {"aperture_z", images[2]},
                     {"volume", volume},
                     {"cut_index", index}},
                    grid.push(0));
  commands.submit();
  const std::vector<float> got_volume = gpu::download<float>(context, volume);
  const std::vector<std::uint32_t> got_index = gpu::download<std::uint32_t>(context, index);
  DomainStatus expected{};
  std::uint32_t cut_seen = 0;
  for (std::size_t i = 0; i < grid.count(); ++i) {
    const bool is_cut = cut.set.has(i);
    const float whole = apertures[0][i] > 0.5f ? 1 : 0, v = is_cut ? cells[++cut_seen].volume : whole;
    ASSERT_EQ(got_volume[i], v) << i;
    ASSERT_EQ(got_index[i], is_cut ? cut_seen : 0) << i;
    expected.inner_cells += !is_cut && whole > 0;
  }
  for (int a = 0; a < 3; ++a) {
    const std::vector<float> got = gpu::download<float>(context, images[a]);
    for (std::size_t i = 0; i < got.size(); i += 4) {
      bool over = false, under = false;
      for (std::size_t k = i; k < i + 4; ++k) {
        const float open = apertures[a][k];
        over = over || open > 1.001f, under = under || open < -0.001f;
        ASSERT_EQ(got[k], open < 1e-5f ? 0 : open > 1 - 1e-5f ? 1 : open) << a << " " << k;
      }
      expected.overlapping_texels += over, expected.inverted_texels += under;
    }
  }
  const DomainStatus got = gpu::download<DomainStatus>(context, status)[0];
  EXPECT_EQ(got.inner_cells, expected.inner_cells);
  EXPECT_EQ(got.overlapping_texels, expected.overlapping_texels);
  EXPECT_EQ(got.inverted_texels, expected.inverted_texels);
}

}  // namespace
}  // namespace alabaster

// The passes that keep sets of cells, one by one: scan, list, mark, pair, totals.
#include "support/domain_sets.h"

#include <algorithm>
#include <cmath>

#include "support/device.h"

namespace alabaster {
namespace {

class DomainSets : public GpuTest {};

TEST_F(DomainSets, ScanAndListEqualTwin) {
  const gpu::Pass scan(context, "domain/scan.comp"), list(context, "domain/list.comp");
  struct Case {
    std::size_t count;
    double density;
  };
  // One word, fewer words than threads, a run that ends inside a thread's share; none, few and all set.
  for (const auto& [count, density] : {Case{1, 1}, Case{32, 1}, Case{33, 0.5}, Case{8000, 0}, Case{8000, 0.02},
                                       Case{8192, 1}, Case{70001, 0.3}, Case{70001, 1}}) {
    Bits set = random_bits(count, density, unsigned(count));
    if (count > 40) set.set(count - 1);
    const auto words = std::uint32_t(set.bits.size());
    const std::vector<std::uint32_t> expected = set.list();
    const gpu::Buffer bits = gpu::make_buffer(context, set.bits, "bits"), before(context, words * 4, "before"),
                      total(context, 12, "total"),
                      listed = gpu::make_buffer(context, std::vector<std::uint32_t>(expected.size() + 1, 77u), "list");
    gpu::Commands commands(context);
    commands.dispatch(scan, {1, 1, 1}, {{"bits", bits}, {"before", before}, {"total", total}}, words);
    commands.dispatch(list, {words, 1, 1}, {{"bits", bits}, {"before", before}, {"list", listed}}, words);
    commands.submit();
    std::vector<std::uint32_t> sums = gpu::download<std::uint32_t>(context, before);
    sums.resize(words);  // buffers are never smaller than 16 bytes
    EXPECT_EQ(sums, set.before()) << count;
    EXPECT_EQ(gpu::download<glm::uvec3>(context, total)[0], glm::uvec3(expected.size(), 1, 1)) << count;
    std::vector<std::uint32_t> got = gpu::download<std::uint32_t>(context, listed);
    EXPECT_EQ(got[expected.size()], 77u) << "nothing beyond the last";
    got.resize(expected.size());
    EXPECT_EQ(got, expected) << count;
  }
}

/// Random triangles: ordinary, in a grid plane facing either way, along a grid line, degenerate, huge, tiny.
struct Triangles {
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  std::vector<glm::uvec2> items;  // triangle, first cell of its box

  void add(glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    const auto first = std::uint32_t(positions.size());
    for (glm::vec3 p : {a, b, c}) positions.push_back(p);
    triangles.push_back({first, first + 1, first + 2});
    const glm::vec3 low = glm::floor(glm::min(glm::min(a, b), c)), high = glm::ceil(glm::max(glm::max(a, b), c));
    const glm::uvec3 size = glm::max(glm::uvec3(high - low), 1u);
    for (std::uint32_t i = 0; i < size.x * size.y * size.z; i += 64)
      items.push_back({std::uint32_t(triangles.size() - 1), i});
  }
  Triangles() {
    std::mt19937 engine(3);
    std::uniform_real_distribution<float> uniform(1.5f, 14.5f);
    const auto point = [&] { return glm::vec3(uniform(engine), uniform(engine), uniform(engine)); };
    for (int i = 0; i < 40; ++i) {
      const glm::vec3 a = point();
      const float size = i % 4 == 0 ? 1.f : 0.1f;
      add(a, glm::mix(a, point(), size), glm::mix(a, point(), size));
    }
    add({2, 3, 5}, {6, 3, 5}, {2, 8, 5});         // in z = 5, facing up
    add({2, 3, 5}, {2, 8, 5}, {6, 3, 5});         // facing down
    add({4, 2.5f, 2}, {4, 9, 3}, {4, 5, 8.25f});  // in x = 4
    add({3, 3, 3}, {3, 3, 9}, {5.5f, 7, 6});      // along a grid line
    add({7, 7, 7}, {9, 9, 9}, {8, 8, 8});         // no area
  }
};

/// Cells whose box meets the triangle's plane, with the margin's tolerance: `sure` leaves out, `possible` takes in,
/// what lies within 2e-4 of the margin.
struct Met {
  std::vector<std::array<std::uint32_t, 2>> sure, possible;
};
Met cells_met(const Triangles& t, const CandidateGrid& grid) {
  Met met;
  for (std::uint32_t k = 0; k < t.triangles.size(); ++k) {
    glm::dvec3 p[3];
    for (int i = 0; i < 3; ++i) p[i] = glm::dvec3(t.positions[t.triangles[k][i]]);
    const glm::dvec3 n = glm::cross(p[1] - p[0], p[2] - p[0]);
    if (n == glm::dvec3(0)) continue;
    const glm::dvec3 normal = glm::normalize(n), low = glm::min(glm::min(p[0], p[1]), p[2]),
                     high = glm::max(glm::max(p[0], p[1]), p[2]);
    glm::ivec3 first(glm::floor(low)), end(glm::ceil(high));
    for (int i = 0; i < 3; ++i)
      if (low[i] == high[i] && low[i] == std::floor(low[i])) first[i] -= n[i] > 0, end[i] = first[i] + 1;
    for (int z = first.z; z < end.z; ++z)
      for (int y = first.y; y < end.y; ++y)
        for (int x = first.x; x < end.x; ++x) {
          const double d = std::abs(glm::dot(normal, glm::dvec3(x, y, z) + 0.5 - p[0])),
                       reach = 0.5 * (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z));
          if (d > reach + 2e-4) continue;
          met.possible.push_back({k, std::uint32_t(grid.at({x, y, z}))});
          if (d <= reach) met.sure.push_back(met.possible.back());
        }
  }
  std::sort(met.sure.begin(), met.sure.end());
  std::sort(met.possible.begin(), met.possible.end());
  return met;
}

TEST_F(DomainSets, MarkAndPairFindTheCellsThatATriangleMeets) {
  const gpu::Pass mark(context, "domain/mark.comp"), pair(context, "domain/pair.comp");
  const CandidateGrid grid({16, 16, 16}, 0, 1);
  const Triangles t;
  const Met met = cells_met(t, grid);
  const gpu::Buffer positions = gpu::make_buffer(context, t.positions, "positions"),
                    triangles = gpu::make_buffer(context, t.triangles, "triangles"),
                    items = gpu::make_buffer(context, t.items, "items"),
                    bits = gpu::make_buffer(context, std::vector<std::uint32_t>(grid.count() / 32), "bits"),
                    status = gpu::make_buffer(context, std::vector<DomainStatus>(1), "status"),
                    pairs(context, met.possible.size() * sizeof(glm::uvec2), "pairs");
  gpu::Commands commands(context);
  commands.dispatch(
      mark, {t.items.size(), 1, 1},
      {{"positions", positions}, {"triangles", triangles}, {"items", items}, {"bits", bits}, {"status", status}},
      grid.push(t.items.size()));
  commands.dispatch(
      pair, {t.items.size(), 1, 1},
      {{"positions", positions}, {"triangles", triangles}, {"items", items}, {"pairs", pairs}, {"status", status}},
      grid.push(t.items.size()));
  commands.submit();
  const DomainStatus counted = gpu::download<DomainStatus>(context, status)[0];
  EXPECT_EQ(counted.pairs, counted.pairs_listed);
  ASSERT_LE(counted.pairs, met.possible.size());
  ASSERT_GE(counted.pairs, met.sure.size());
  std::vector<std::array<std::uint32_t, 2>> got;
  for (glm::uvec2 p : gpu::download<glm::uvec2>(context, pairs)) got.push_back({p.x, p.y});
  got.resize(counted.pairs);
  std::sort(got.begin(), got.end());
  EXPECT_TRUE(std::includes(got.begin(), got.end(), met.sure.begin(), met.sure.end()));
  EXPECT_TRUE(std::includes(met.possible.begin(), met.possible.end(), got.begin(), got.end()));
  EXPECT_TRUE(std::adjacent_find(got.begin(), got.end()) == got.end()) << "a pair twice";
  Bits expected(grid.count());
  for (const auto& p : got) expected.set(p[1]);
  EXPECT_EQ(gpu::download<std::uint32_t>(context, bits), expected.bits);
}

TEST_F(DomainSets, TotalsAddUpTheCutCells) {
  const gpu::Pass totals(context, "domain/totals.comp");
  struct Total {
    float volume, area;
    glm::vec3 area_vector;
  };
  std::mt19937 engine(4);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (std::uint32_t count : {1u, 63u, 64u, 65u, 1000u}) {
    std::vector<GpuCutCell> cells(count + 1);
    for (GpuCutCell& c : cells) {  // entry 0 does not count
      c.volume = uniform(engine), c.facet.area = uniform(engine);
      c.facet.area_vector = {uniform(engine), uniform(engine), uniform(engine)};
    }
    const gpu::Buffer buffer = gpu::make_buffer(context, cells, "cut cells"),
                      sums(context, (count + 63) / 64 * sizeof(Total), "totals");
    gpu::Commands commands(context);
    commands.dispatch(totals, {count, 1, 1}, {{"cut_cells", buffer}, {"totals", sums}}, count);
    commands.submit();
    const std::vector<Total> got = gpu::download<Total>(context, sums);
    for (std::size_t group = 0; group < got.size(); ++group) {
      double volume = 0, area = 0;
      glm::dvec3 vector(0);
      for (std::size_t i = 64 * group; i < std::min<std::size_t>(count, 64 * group + 64); ++i) {
        volume += cells[i + 1].volume, area += cells[i + 1].facet.area;
        vector += glm::dvec3(cells[i + 1].facet.area_vector);
      }
      EXPECT_NEAR(got[group].volume, volume, 1e-5) << count;
      EXPECT_NEAR(got[group].area, area, 1e-5) << count;
      EXPECT_LT(glm::length(glm::dvec3(got[group].area_vector) - vector), 1e-5) << count;
    }
  }
}

}  // namespace
}  // namespace alabaster

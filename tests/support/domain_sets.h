// Sets of numbered bits as shaders/domain/ keep them, and random sums of surface, for tests of its passes one by one.
#pragma once

#include <bit>
#include <deque>
#include <random>
#include <vector>

#include "gpu/commands.h"
#include "shared/domain.h"

namespace alabaster {

/// Inputs of a pass, which live until it has run.
class Inputs {
 public:
  explicit Inputs(gpu::Context& context) : context_(context) {}
  template <class T>
  const gpu::Buffer& operator()(const std::vector<T>& values, const char* name) {
    return buffers_.emplace_back(gpu::make_buffer(context_, values, name));
  }

 private:
  gpu::Context& context_;
  std::deque<gpu::Buffer> buffers_;
};

struct Bits {
  explicit Bits(std::size_t count) : bits((count + 31) / 32, 0) {}
  void set(std::size_t i) { bits[i / 32] |= 1u << (i % 32); }
  bool has(std::size_t i) const { return bits[i / 32] >> (i % 32) & 1; }
  std::vector<std::uint32_t> before() const {  // bits set before each word
    std::vector<std::uint32_t> sums;
    std::uint32_t sum = 0;
    for (std::uint32_t word : bits) sums.push_back(sum), sum += std::popcount(word);
    return sums;
  }
  std::vector<std::uint32_t> list() const {
    std::vector<std::uint32_t> set_bits;
    for (std::size_t i = 0; i < 32 * bits.size(); ++i)
      if (has(i)) set_bits.push_back(std::uint32_t(i));
    return set_bits;
  }
  std::size_t rank(std::size_t i) const {
    std::size_t sum = 0;
    for (std::size_t k = 0; k < i; ++k) sum += has(k);
    return sum;
  }
  std::vector<std::uint32_t> bits;
};

inline Bits random_bits(std::size_t count, double density, unsigned seed) {
  std::mt19937 engine(seed);
  std::bernoulli_distribution set(density);
  Bits made(count);
  for (std::size_t i = 0; i < count; ++i)
    if (set(engine)) made.set(i);
  return made;
}

/// A grid with candidates among its cells.
struct CandidateGrid {
  CandidateGrid(glm::ivec3 size, double density, unsigned seed)
      : cells(size), set(random_bits(count(), density, seed)), list(set.list()), rank_of(count(), -1) {
    for (std::size_t r = 0; r < list.size(); ++r) rank_of[list[r]] = int(r);
  }
  std::size_t count() const { return std::size_t(cells.x) * cells.y * cells.z; }
  std::size_t at(glm::ivec3 c) const { return c.x + std::size_t(cells.x) * (c.y + std::size_t(cells.y) * c.z); }
  glm::ivec3 cell(std::size_t i) const {
    return {int(i % cells.x), int(i / cells.x % cells.y), int(i / (std::size_t(cells.x) * cells.y))};
  }
  bool inside(glm::ivec3 c) const { return glm::all(glm::lessThan(glm::uvec3(c), glm::uvec3(cells))); }
  int rank(glm::ivec3 c) const { return inside(c) ? rank_of[at(c)] : -1; }
  DomainPush push(std::size_t threads) const { return {cells, std::uint32_t(threads)}; }
  std::size_t texel_value(glm::ivec3 c) const { return at(c); }  // four x-neighbours a texel: the same order

  glm::ivec3 cells;
  Bits set;
  std::vector<std::uint32_t> list;
  std::vector<int> rank_of;
};

/// The sums of a candidate cell as integers of 2^-24: six classes of A (3), S, X (3), M (9), Q (3).
inline constexpr int sums_a_class = 19, at_A = 0, at_S = 3, at_X = 4, at_M = 7, at_Q = 16;
inline constexpr double sums_one = 16777216;

struct SurfaceSums {
  std::vector<std::int32_t> values;
  double of(std::size_t rank, int kind, int which) const {
    return values[(6 * rank + kind) * sums_a_class + which] / sums_one;
  }
  glm::dvec3 three(std::size_t rank, int kind, int which) const {
    return {of(rank, kind, which), of(rank, kind, which + 1), of(rank, kind, which + 2)};
  }
};

/// Flat pieces of surface somewhere in each cell, of some of the classes; one cell in eight has none.
inline SurfaceSums random_sums(std::size_t count, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  SurfaceSums sums{std::vector<std::int32_t>(count * 6 * sums_a_class, 0)};
  for (std::size_t rank = 0; rank < count; ++rank)
    for (int kind = 0; kind < 6; ++kind) {
      if (rank % 8 == 7 || uniform(engine) < 0.5) continue;
      glm::dvec3 n(0.4 * uniform(engine), 0.4 * uniform(engine), 0.4 * uniform(engine)), x, q;
      n[kind / 2] = kind % 2 ? -1 : 1;
      n = glm::normalize(n);
      const double area = 0.05 + 0.9 * uniform(engine);
      for (int i = 0; i < 3; ++i) x[i] = uniform(engine), q[i] = 0.5 * n[i] * x[i] * x[i];
      const auto put = [&](int which, double v) {
        sums.values[(6 * rank + kind) * sums_a_class + which] = std::int32_t(std::lround(v * area * sums_one));
      };
      put(at_S, 1);
      for (int i = 0; i < 3; ++i) {
        put(at_A + i, n[i]), put(at_X + i, x[i]), put(at_Q + i, q[i]);
        for (int j = 0; j < 3; ++j) put(at_M + 3 * i + j, n[i] * x[j]);
      }
    }
  return sums;
}

}  // namespace alabaster

#include "diffusion/islands.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>

namespace alabaster {
namespace {

constexpr float strong = 0.01f;       // of the larger diagonal: a face that conducts more than this joins two cells
constexpr double rough_share = 0.01;  // of the cells within, that lie at a jump, in a rough medium
constexpr double isolated = 0.1;  // of an island's largest diagonal: what leaves it, a boundary face, is at most this

struct Grid {
  glm::ivec3 n;
  std::vector<float> entries[DIFFUSION_FINEST_ENTRIES];  // of every cell

  Grid(glm::ivec3 size, std::span<const float> stencil) : n(size) {
    for (auto& entry : entries) entry.resize(cells());
    tbb::parallel_for(tbb::blocked_range<int>(0, n.y * n.z, 64), [&](const tbb::blocked_range<int>& rows) {
      for (int row = rows.begin(); row < rows.end(); ++row)
        for (int entry = 0; entry < DIFFUSION_FINEST_ENTRIES; ++entry)
          std::copy_n(&stencil[std::size_t(n.x) * (entry + DIFFUSION_FINEST_ENTRIES * std::size_t(row))], n.x,
                      &entries[entry][std::size_t(n.x) * row]);
    });
  }
  int cells() const { return n.x * n.y * n.z; }
  glm::ivec3 cell(int i) const { return {i % n.x, i / n.x % n.y, i / (n.x * n.y)}; }
  int step(int axis) const { return axis == 0 ? 1 : axis == 1 ? n.x : n.x * n.y; }
  float at(int entry, int i) const { return entries[entry][i]; }
  /// Conductance of face 0..5 (towards -x, +x, -y, ...), 0 where there is none. Grids have an empty margin all around.
  float face(int side, int i) const {
    const int axis = side / 2, upper = i + (side & 1) * step(axis);
    return upper < cells() ? at(axis, upper) : 0.f;
  }
  int beyond(int side, int i) const { return i + (side & 1 ? 1 : -1) * step(side / 2); }
};

struct Component {
  std::vector<int> cells;
  double reaction = 0, leaving = 0, largest = 0;
  int faces = 0;
  double energy() const { return reaction + leaving; }  // Z^T A Z
  double isolation() const { return faces == 0 ? 1 : energy() / (largest * faces); }
};

class Forest {  // union-find
 public:
  explicit Forest(int n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  int root(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(int i, int j) {
    i = root(i), j = root(j);
    parent_[std::max(i, j)] = std::min(i, j);
  }

 private:
  std::vector<int> parent_;
};

std::vector<Component> components(const Grid& grid, const std::vector<float>& diagonal, std::vector<int>& number) {
  Forest forest(grid.cells());
  for (int axis = 0; axis < 3; ++axis)
    for (int i = grid.step(axis); i < grid.cells(); ++i) {
      const int below = i - grid.step(axis);
      if (grid.at(axis, i) > strong * std::max(diagonal[i], diagonal[below])) forest.join(i, below);
    }
  number.assign(grid.cells(), -1);
  std::vector<Component> list;
  for (int i = 0; i < grid.cells(); ++i) {
    if (diagonal[i] <= 0) continue;
    const int root = forest.root(i);  // the first of its cells
    if (root == i) {
      number[i] = static_cast<int>(list.size());
      list.emplace_back();
    }
    number[i] = number[root];
    list[number[i]].cells.push_back(i);
  }
  return list;
}

// Of faces in ascending order. Two materials that meet have two: their harmonic mean is the weaker one's, or twice it.
bool three_magnitudes(const std::array<float, 6>& faces) {
  int magnitudes = 1;
  float last = faces.front();
  for (const float face : faces)
    if (face > DIFFUSION_MAGNITUDE * last) ++magnitudes, last = face;
  return magnitudes >= 3;
}

Roughness both(const Roughness& a, const Roughness& b) {
  return {a.all + b.all,     a.within + b.within, a.jumps + b.jumps,
          a.noisy + b.noisy, a.deep + b.deep,     a.deep_jumps + b.deep_jumps};
}

float diagonal_of(const Grid& grid, int i) {
  float sum = grid.at(DIFFUSION_REACTION, i);
  for (int side = 0; side < 6; ++side) sum += grid.face(side, i);
  return sum;
}

// Few deep cells are a thin object's: there all that are within have to say.
bool deep_enough(const Roughness& r) { return 2 * r.deep > r.within; }

}  // namespace

Roughness roughness(glm::ivec3 n, std::span<const float> stencil) {
  const Grid grid(n, stencil);
  const auto cells = [&](const tbb::blocked_range<int>& range, Roughness found) {
    for (int i = range.begin(); i < range.end(); ++i) {
      found.all += diagonal_of(grid, i) > 0;
      std::array<float, 6> faces;
      for (int side = 0; side < 6; ++side) faces[side] = grid.face(side, i);
      const auto [least, most] = std::minmax_element(faces.begin(), faces.end());
      if (*least <= 0) continue;
      ++found.within;
      bool deep = true;
      for (int side = 0; side < 6; ++side)
        for (int face = 0; face < 6; ++face) deep = deep && grid.face(face, grid.beyond(side, i)) > 0;
      found.deep += deep;
      if (*most <= DIFFUSION_JUMP * *least) continue;
      ++found.jumps;
      found.deep_jumps += deep;
      std::sort(faces.begin(), faces.end());
      found.noisy += three_magnitudes(faces);
    }
    return found;
  };
  return tbb::parallel_reduce(tbb::blocked_range<int>(0, grid.cells(), 1 << 14), Roughness{}, cells, both);
}

bool is_rough(const Roughness& r) {
  return deep_enough(r) ? r.deep_jumps > rough_share * r.deep : r.jumps > rough_share * r.within;
}

double noise_share(const Roughness& r) { return r.within > 0 ? double(r.noisy) / r.within : 0.0; }

bool may_have_islands(const Roughness& r) {
  if (2 * r.within <= r.all) return true;
  return deep_enough(r) ? r.deep_jumps > 0 : r.jumps > 0;
}

Islands find_islands(glm::ivec3 n, std::span<const float> stencil) {
  Islands islands;
  islands.labels.assign(std::size_t(n.x) * n.y * n.z, 0);
  if (std::max({n.x, n.y, n.z}) > DIFFUSION_ISLAND_CELLS) return islands;
  const Grid grid(n, stencil);
  std::vector<float> diagonal(grid.cells());
  tbb::parallel_for(0, grid.cells(), [&](int i) { diagonal[i] = diagonal_of(grid, i); });
  const auto active = std::count_if(diagonal.begin(), diagonal.end(), [](float d) { return d > 0; });
  std::vector<int> number;
  std::vector<Component> list = components(grid, diagonal, number);
  const auto leaves = [&](int i, int side) {
    return grid.face(side, i) > 0 && number[grid.beyond(side, i)] != number[i];
  };
  std::vector<int> order;
  for (std::size_t k = 0; k < list.size(); ++k) {
    Component& c = list[k];
    // Single cells are the smoother's, most of the object is the coarse grids'.
    if (c.cells.size() < 2 || 2 * std::ptrdiff_t(c.cells.size()) > active) continue;
    for (int i : c.cells) {
      c.reaction += grid.at(DIFFUSION_REACTION, i);
      c.largest = std::max(c.largest, double(diagonal[i]));
      for (int side = 0; side < 6; ++side)
        if (leaves(i, side)) c.leaving += grid.face(side, i), ++c.faces;
    }
    if (c.energy() > 0 && c.isolation() <= isolated) order.push_back(static_cast<int>(k));
  }
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    const double x = list[a].isolation(), y = list[b].isolation();
    return x != y ? x < y : a < b;
  });
  for (int k : order) {
    const Component& c = list[k];
    std::vector<std::uint32_t> faces;
    bool touches = false;
    const auto start = static_cast<std::uint32_t>(islands.entries.size());
    for (int i : c.cells) {
      const glm::uvec3 p(grid.cell(i));
      const std::uint32_t place = p.x | p.y << 9 | p.z << 18;
      islands.entries.push_back(place | std::uint32_t(DIFFUSION_ISLAND_CELL) << 27);
      for (int side = 0; side < 6; ++side)
        if (leaves(i, side)) {
          faces.push_back(place | std::uint32_t(side) << 27);
          touches = touches || islands.labels[grid.beyond(side, i)] > 0;
        }
    }
    if (touches) {
      islands.entries.resize(start);
      continue;
    }
    const auto middle = static_cast<std::uint32_t>(islands.entries.size());
    islands.entries.insert(islands.entries.end(), faces.begin(), faces.end());
    islands.spans.push_back(
        {start, middle, static_cast<std::uint32_t>(islands.entries.size()), static_cast<float>(1 / c.energy())});
    for (int i : c.cells) islands.labels[i] = static_cast<std::uint32_t>(islands.spans.size());
  }
  return islands;
}

}  // namespace alabaster

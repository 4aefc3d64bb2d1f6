// Small diffusion problems for tests: shapes on a grid, media, and the way to and from the packed images.
#pragma once

#include <random>

#include "diffusion/pcg.h"
#include "diffusion/twin_problem.h"
#include "scene/shapes.h"

namespace alabaster {

/// `mesh` on a grid of about `n` cells along its longest side.
inline CutCells gridded(const Mesh& mesh, int n) { return cut_cells(mesh, choose_frame(bounds_of(mesh), n)); }

/// kappa that alternates between `kappa` and kappa / contrast in blocks of `block` metres; sigma_a the same everywhere.
inline twin::MaterialField checker(double kappa, double contrast, double block, double sigma_a = 0) {
  return [=](glm::dvec3 p) {
    const glm::ivec3 b = glm::ivec3(glm::floor(p / block));
    return twin::Material{(b.x + b.y + b.z) & 1 ? kappa / contrast : kappa, sigma_a};
  };
}

/// kappa that alternates between `kappa` and kappa / contrast in layers of 1/8 m along z.
inline twin::MaterialField sharp_layers(double kappa, double contrast) {
  return [=](glm::dvec3 p) {
    return twin::Material{static_cast<int>(std::floor(8 * p.z)) & 1 ? kappa : kappa / contrast, 0};
  };
}

/// kappa whose logarithm wanders smoothly between that of `kappa` and of kappa / contrast.
inline twin::MaterialField log_smooth(double kappa, double contrast) {
  return [=](glm::dvec3 p) {
    const double s = std::sin(19 * p.x + 3 * p.y + 1) * std::sin(23 * p.y - 4 * p.z) * std::sin(17 * p.z + 5 * p.x + 2);
    return twin::Material{kappa * std::pow(contrast, 0.5 * (s - 1)), 0};
  };
}

inline std::vector<float> pack(const std::vector<const twin::Vector*>& entries, const twin::Lattice& grid) {
  const int nx = (grid.n.x + 3) / 4 * 4, count = static_cast<int>(entries.size());
  std::vector<float> packed(std::size_t(nx) * count * grid.n.y * grid.n.z, 0.f);
  for (int z = 0; z < grid.n.z; ++z)
    for (int y = 0; y < grid.n.y; ++y)
      for (int k = 0; k < count; ++k)
        for (int x = 0; x < grid.n.x; ++x)
          packed[x + std::size_t(nx) * (k + count * (y + std::size_t(grid.n.y) * z))] =
              static_cast<float>((*entries[k])[grid.at({x, y, z})]);
  return packed;
}

/// Entry `k` of `count` of channel `channel`.
inline twin::Vector unpack(const std::vector<float>& packed, const twin::Lattice& grid, int k, int count, int channel) {
  const int nx = (grid.n.x + 3) / 4 * 4;
  twin::Vector v(grid.size(), 0.0);
  for (int z = 0; z < grid.n.z; ++z)
    for (int y = 0; y < grid.n.y; ++y)
      for (int x = 0; x < grid.n.x; ++x)
        v[grid.at({x, y, z})] =
            packed[x + std::size_t(nx) * (k + count * (y + std::size_t(grid.n.y) * (z + channel * grid.n.z)))];
  return v;
}

/// The finest stencil as the device holds it: three face conductances and the reaction.
inline std::vector<float> pack_finest(const twin::Operator& a) {
  twin::Vector faces[3], reaction = a.a[twin::diagonal];
  for (int axis = 0; axis < 3; ++axis) {
    faces[axis].assign(a.grid.size(), 0.0);
    glm::ivec3 up(0);
    up[axis] = 1;
    for (std::size_t i = 0; i < reaction.size(); ++i) faces[axis][i] = -a.a[twin::low_face[axis]][i];
    for (std::size_t i = 0; i + a.grid.shift(up) < reaction.size(); ++i)
      reaction[i] -= faces[axis][i] + faces[axis][i + a.grid.shift(up)];
  }
  return pack({&faces[0], &faces[1], &faces[2], &reaction}, a.grid);
}

inline TileList tile_list(gpu::Context& context, const twin::Operator& a) {
  std::vector<std::uint32_t> packed;
  const glm::ivec3 tile(4 * DIFFUSION_TILE_X, DIFFUSION_TILE_Y, 1), n = a.grid.n, counts = (n + tile - 1) / tile;
  for (int z = 0; z < counts.z; ++z)
    for (int y = 0; y < counts.y; ++y)
      for (int x = 0; x < counts.x; ++x) {
        bool active = false;
        for (int j = y * tile.y; j < std::min(n.y, (y + 1) * tile.y); ++j)
          for (int i = x * tile.x; i < std::min(n.x, (x + 1) * tile.x); ++i)
            active = active || a.a[twin::diagonal][a.grid.at({i, j, z})] > 0;
        if (active) packed.push_back(x | y << 10 | z << 20);
      }
  return {gpu::make_buffer(context, packed, "tiles"), static_cast<int>(packed.size())};
}

inline twin::Vector random_on(const twin::Operator& a, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  twin::Vector v(a.grid.size(), 0.0);
  for (int z = 0; z < a.grid.n.z; ++z)
    for (int y = 0; y < a.grid.n.y; ++y)
      for (int x = 0; x < a.grid.n.x; ++x) {
        const double value = uniform(engine);
        if (a.a[twin::diagonal][a.grid.at({x, y, z})] > 0) v[a.grid.at({x, y, z})] = value;
      }
  return v;
}

/// Largest difference, relative to the largest entry of `expected`.
inline double worst_difference(const twin::Vector& got, const twin::Vector& expected) {
  double worst = 0, scale = 0;
  for (std::size_t i = 0; i < got.size(); ++i) {
    worst = std::max(worst, std::abs(got[i] - expected[i]));
    scale = std::max(scale, std::abs(expected[i]));
  }
  return worst == 0 ? 0 : worst / scale;
}

}  // namespace alabaster

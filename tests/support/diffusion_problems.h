// Small diffusion problems for tests: shapes on a grid, media, and the way to and from the packed images.
#pragma once

#include <cstring>
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

/// The stencil that the device's cycle applies to the finest level, from its packed form (shared/diffusion.h), and the
/// reciprocal l1 norms in it.
struct PackedStencil {
  twin::Operator a;
  twin::Vector inverse_l1;
  bool symmetric = true;  // both sides of every face say the same
};

inline float bf16(std::uint32_t bits) {
  bits <<= 16;
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

inline PackedStencil unpack_pairs(const std::vector<std::uint32_t>& texels, const twin::Lattice& grid, int channel) {
  const int nx = (grid.n.x + 3) / 4 * 4;
  PackedStencil out{twin::Operator::seven_point(grid.n), twin::Vector(grid.size(), 0.0)};
  const auto word = [&](int k, glm::ivec3 c) -> std::uint32_t {
    if (!grid.inside(c)) return 0;
    const std::size_t row = c.y + std::size_t(grid.n.y) * (c.z + channel * grid.n.z);
    return texels[c.x + std::size_t(nx) * (k + DIFFUSION_PAIRS * row)];
  };
  for (int z = 0; z < grid.n.z; ++z)
    for (int y = 0; y < grid.n.y; ++y)
      for (int x = 0; x < grid.n.x; ++x) {
        const glm::ivec3 c{x, y, z};
        const std::ptrdiff_t i = grid.at(c);
        double sum = 0;  // of the conductances
        for (int k = 0; k < 3; ++k) {
          const int entry = twin::low_face[k];
          const float low = bf16(word(k, c) & 0xffff), high = bf16(word(k, c) >> 16);
          out.a.a[entry][i] = -low;
          out.symmetric = out.symmetric && low == bf16(word(k, c + twin::offset(entry)) >> 16);
          sum += low + high;
        }
        const std::uint32_t rest = word(DIFFUSION_REACTION, c);
        out.a.a[twin::diagonal][i] = bf16(rest & 0xffff) + sum;
        out.inverse_l1[i] = bf16(rest >> 16);
      }
  return out;
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

/// Of the cells that `a` has: what Multigrid asks for.
inline std::vector<std::uint8_t> active_cells(const twin::Operator& a) {
  std::vector<std::uint8_t> active;
  for (int z = 0; z < a.grid.n.z; ++z)
    for (int y = 0; y < a.grid.n.y; ++y)
      for (int x = 0; x < a.grid.n.x; ++x) active.push_back(a.a[twin::diagonal][a.grid.at({x, y, z})] > 0);
  return active;
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

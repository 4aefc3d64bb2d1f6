#include "diffusion/twin.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

#include "diffusion/dense.h"

namespace alabaster::twin {

namespace {

template <typename F>
void for_cells(const Lattice& grid, F f) {
  tbb::parallel_for(0, grid.n.z, [&](int z) {
    for (int y = 0; y < grid.n.y; ++y)
      for (int x = 0; x < grid.n.x; ++x) f(glm::ivec3(x, y, z), grid.at({x, y, z}));
  });
}

int odd_axes(glm::ivec3 c) { return (c.x & 1) + (c.y & 1) + (c.z & 1); }

}  // namespace

Operator Operator::seven_point(glm::ivec3 n) {
  Operator a;
  a.grid.n = n;
  a.couplings.assign(low_face, low_face + 3);
  for (int k : low_face) a.a[k].assign(a.grid.size(), 0.0);
  a.a[diagonal].assign(a.grid.size(), 0.0);
  return a;
}

double Operator::coupling(std::ptrdiff_t i, glm::ivec3 d) const {
  int k = entry(d);
  if (k > diagonal) return a[26 - k].empty() ? 0.0 : a[26 - k][i + grid.shift(d)];
  return a[k].empty() ? 0.0 : a[k][i];
}

void Operator::apply(const Vector& x, Vector& y) const {
  y.resize(grid.size());
  tbb::parallel_for(0, grid.n.z, [&](int z) {
    for (int row = 0; row < grid.n.y; ++row) {
      std::ptrdiff_t begin = grid.at({0, row, z}), end = begin + grid.n.x;
      for (std::ptrdiff_t i = begin; i < end; ++i) y[i] = a[diagonal][i] * x[i];
      for (int k : couplings) {
        std::ptrdiff_t s = grid.shift(offset(k));
        const double* c = a[k].data();
        for (std::ptrdiff_t i = begin; i < end; ++i) y[i] += c[i] * x[i + s] + c[i - s] * x[i - s];
      }
    }
  });
}

Vector Operator::inverse_l1() const {
  Vector result(grid.size(), 0.0);
  for_cells(grid, [&](glm::ivec3, std::ptrdiff_t i) {
    double sum = a[diagonal][i];
    if (sum <= 0) return;
    for (int k : couplings) sum += std::abs(a[k][i]) + std::abs(a[k][i - grid.shift(offset(k))]);
    result[i] = 1 / sum;
  });
  return result;
}

// A fine point with odd coordinates along m axes interpolates, by its own equation, from its neighbours with fewer odd
// coordinates in the span of those axes; along the other axes the stencil is collapsed (summed), as if the solution
// were constant there. The reaction stays in the collapsed diagonal, so weights fall below 1 where light is absorbed.
// Couplings of the wrong sign, and row sums below zero, which coarse operators of sharp media have, count as none: with
// them the collapsed diagonal may all but vanish. So weights are from 0 to 1.
// A point without such neighbours (a sheet or needle at odd index) stands for its own block: weight 1.
Interpolation::Interpolation(const Operator& a) : fine(a.grid), coarse(a.grid.coarser()) {
  for (Vector& w : p) w.assign(coarse.size(), 0.0);
  for (int odd = 0; odd <= 3; ++odd) {
    for_cells(coarse, [&](glm::ivec3 I, std::ptrdiff_t at_coarse) {
      for (int k = 0; k < 27; ++k) {
        glm::ivec3 d = offset(k), f = 2 * I + d;
        if (odd_axes(d) != odd || !fine.inside(f)) continue;
        std::ptrdiff_t i = fine.at(f);
        if (a.a[diagonal][i] <= 0) continue;
        double row_sum = 0, lower = 0, here = 0;
        for (int m = 0; m < 27; ++m) {
          glm::ivec3 e = offset(m), within = e * glm::abs(d);
          const double c = a.coupling(i, e);
          row_sum += c;
          if (within == glm::ivec3(0) || c >= 0) continue;
          lower -= c;
          glm::ivec3 from = d + within;  // as seen from coarse I
          if (glm::all(glm::lessThanEqual(glm::abs(from), glm::ivec3(1)))) here -= c * p[entry(from)][at_coarse];
        }
        bool own_block = glm::all(glm::greaterThanEqual(d, glm::ivec3(0)));
        bool orphan = lower <= 1e-7 * a.a[diagonal][i];
        p[k][at_coarse] = orphan ? (own_block ? 1.0 : 0.0) : here / (std::max(row_sum, 0.0) + lower);
      }
    });
  }
}

void Interpolation::prolong_add(const Vector& e, Vector& x) const {
  for_cells(fine, [&](glm::ivec3 f, std::ptrdiff_t i) {
    glm::ivec3 low = f / 2, odd = f & 1;
    double sum = 0;
    for (int c = 0; c < 8; ++c) {
      glm::ivec3 up{c & 1, c >> 1 & 1, c >> 2};
      if (glm::any(glm::greaterThan(up, odd))) continue;
      glm::ivec3 I = low + up;
      std::ptrdiff_t at = coarse.at(I);
      sum += p[entry(f - 2 * I)][at] * e[at];
    }
    x[i] += sum;
  });
}

void Interpolation::restrict_to(const Vector& r, Vector& b) const {
  b.resize(coarse.size());
  for_cells(coarse, [&](glm::ivec3 I, std::ptrdiff_t at) {
    double sum = 0;
    for (int k = 0; k < 27; ++k)
      if (p[k][at] != 0) sum += p[k][at] * r[fine.at(2 * I + offset(k))];
    b[at] = sum;
  });
}

Operator Interpolation::galerkin(const Operator& a) const {
  Operator g;
  g.grid = coarse;
  for (int k = 0; k < diagonal; ++k) g.couplings.push_back(k);
  for (Vector& v : g.a) v.assign(coarse.size(), 0.0);
  for_cells(coarse, [&](glm::ivec3 I, std::ptrdiff_t at) {
    for (int k = 0; k <= diagonal; ++k) {
      glm::ivec3 D = offset(k);
      if (!coarse.inside(I + D)) continue;
      std::ptrdiff_t other = coarse.at(I + D);
      double sum = 0;
      for (int m = 0; m < 27; ++m) {
        if (p[m][at] == 0) continue;
        std::ptrdiff_t i = fine.at(2 * I + offset(m));
        for (int e = 0; e < 27; ++e) {
          glm::ivec3 j = offset(m) + offset(e) - 2 * D;  // fine neighbour as seen from the other coarse cell
          if (glm::any(glm::greaterThan(glm::abs(j), glm::ivec3(1)))) continue;
          double w = p[entry(j)][other];
          if (w != 0) sum += p[m][at] * a.coupling(i, offset(e)) * w;
        }
      }
      g.a[k][at] = sum;
    }
  });
  return g;
}

std::vector<double> chebyshev_omegas(int steps, double lowest) {
  std::vector<double> omegas;
  for (int k = 0; k < steps; ++k) {
    double root = std::cos(M_PI * (k + 0.5) / steps);
    omegas.push_back(2 / ((1 + lowest) + (1 - lowest) * root));
  }
  return omegas;
}

Multigrid::Multigrid(Operator finest, CycleOptions options) : options_(options) {
  const Smoothing& smoothing = is_rough(roughness(finest.grid.n, stencil_of(finest))) ? options.rough : options.even;
  levels_.push_back({std::move(finest), {}, {}, {}, {}, {}});
  while (true) {
    glm::ivec3 n = levels_.back().a.grid.n;
    if (!interpolations_.empty() && n.x * n.y * n.z <= options.direct_cells) break;
    interpolations_.emplace_back(levels_.back().a);
    levels_.push_back({interpolations_.back().galerkin(levels_.back().a), {}, {}, {}, {}, {}});
  }
  for (Level& level : levels_) {
    level.inverse_l1 = level.a.inverse_l1();
    for (Vector* v : {&level.x, &level.b, &level.r}) v->assign(level.a.grid.size(), 0.0);
  }
  omegas_ = chebyshev_omegas(smoothing.sweeps, smoothing.lowest);
  factor_coarsest();
}

void Multigrid::factor_coarsest() {
  const Operator& a = levels_.back().a;
  std::vector<int> number(a.grid.size(), -1);
  for (int z = 0; z < a.grid.n.z; ++z)
    for (int y = 0; y < a.grid.n.y; ++y)
      for (int x = 0; x < a.grid.n.x; ++x) {
        number[a.grid.at({x, y, z})] = int(coarsest_cells_.size());
        coarsest_cells_.push_back(a.grid.at({x, y, z}));
      }
  int n = int(coarsest_cells_.size());
  Vector dense(std::size_t(n) * n, 0.0);
  for (int row = 0; row < n; ++row)
    for (int k = 0; k < 27; ++k) {
      std::ptrdiff_t i = coarsest_cells_[row];
      int column = number[i + a.grid.shift(offset(k))];
      if (column >= 0) dense[std::size_t(row) * n + column] = a.coupling(i, offset(k));
    }
  coarsest_inverse_ = invert_spd(std::move(dense), n, 1e-13);
}

void Multigrid::smooth(Level& level, bool from_zero) {
  for (std::size_t s = 0; s < omegas_.size(); ++s) {
    if (from_zero && s == 0) {
      for (std::size_t i = 0; i < level.x.size(); ++i) level.x[i] = omegas_[s] * level.inverse_l1[i] * level.b[i];
      continue;
    }
    level.in_cycle().apply(level.x, level.r);
    tbb::parallel_for(std::size_t(0), level.x.size(), [&](std::size_t i) {
      level.x[i] += omegas_[s] * level.inverse_l1[i] * (level.b[i] - level.r[i]);
    });
  }
}

void Multigrid::cycle(std::size_t l) {
  Level& level = levels_[l];
  if (l + 1 == levels_.size()) {
    std::size_t n = coarsest_cells_.size();
    for (std::size_t r = 0; r < n; ++r) {
      double sum = 0;
      for (std::size_t c = 0; c < n; ++c) sum += coarsest_inverse_[r * n + c] * level.b[coarsest_cells_[c]];
      level.x[coarsest_cells_[r]] = sum;
    }
    return;
  }
  smooth(level, true);
  level.in_cycle().apply(level.x, level.r);  // r = b - A x
  for (std::size_t i = 0; i < level.r.size(); ++i) level.r[i] = level.b[i] - level.r[i];
  interpolations_[l].restrict_to(level.r, levels_[l + 1].b);  // b' = P^T r
  cycle(l + 1);
  interpolations_[l].prolong_add(levels_[l + 1].x, level.x);  // x += P x'
  smooth(level, false);
}

void Multigrid::smooth_with(std::size_t l, Operator rounded, Vector inverse_l1) {
  levels_[l].rounded = std::move(rounded);
  levels_[l].inverse_l1 = std::move(inverse_l1);
}

void Multigrid::precondition(const Vector& r, Vector& z) {
  levels_[0].b = r;
  cycle(0);
  z = levels_[0].x;
}

double dot(const Vector& a, const Vector& b) {
  return tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, a.size(), 4096), 0.0,
      [&](const tbb::blocked_range<std::size_t>& range, double sum) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) sum += a[i] * b[i];
        return sum;
      },
      std::plus<double>());
}

std::vector<float> stencil_of(const Operator& a) {
  const glm::ivec3 n = a.grid.n;
  std::vector<float> stencil(std::size_t(DIFFUSION_FINEST_ENTRIES) * n.x * n.y * n.z);
  for_cells(a.grid, [&](glm::ivec3 c, std::ptrdiff_t i) {
    double reaction = a.a[diagonal][i];
    const auto entry_at = [&](int k) -> float& {
      return stencil[c.x + std::size_t(n.x) * (k + DIFFUSION_FINEST_ENTRIES * (c.y + std::size_t(n.y) * c.z))];
    };
    for (int axis = 0; axis < 3; ++axis) {
      glm::ivec3 up(0);
      up[axis] = 1;
      entry_at(axis) = static_cast<float>(-a.coupling(i, -up));
      reaction += a.coupling(i, -up) + a.coupling(i, up);
    }
    entry_at(DIFFUSION_REACTION) = static_cast<float>(reaction);
  });
  return stencil;
}

Deflation::Deflation(const Operator& a) {
  const std::vector<float> stencil = stencil_of(a);
  if (!may_have_islands(roughness(a.grid.n, stencil))) return;
  const Islands found = find_islands(a.grid.n, stencil);
  Vector one(a.grid.size(), 0.0);  // 1 on the island at hand
  for (const IslandSpan& span : found.spans) {
    Island island;
    for (std::uint32_t k = span.cells; k < span.faces; ++k) {
      const std::uint32_t e = found.entries[k];
      island.cells.push_back(a.grid.at({e & 511u, e >> 9 & 511u, e >> 18 & 511u}));
      one[island.cells.back()] = 1;
    }
    for (std::ptrdiff_t i : island.cells)
      for (int k = 0; k < 27; ++k) island.energy += a.coupling(i, offset(k)) * one[i + a.grid.shift(offset(k))];
    for (std::ptrdiff_t i : island.cells) one[i] = 0;
    islands_.push_back(std::move(island));
  }
}

void Deflation::lift(const Vector& r, Vector& z) const {
  for (const Island& island : islands_) {
    double sum = 0;
    for (std::ptrdiff_t i : island.cells) sum += r[i];
    for (std::ptrdiff_t i : island.cells) z[i] += sum / island.energy;
  }
}

Solution solve_pcg(Multigrid& multigrid, const Vector& b, double tolerance, int max_iterations) {
  const Operator& a = multigrid.finest();
  const Deflation deflation(a);
  Solution s;
  s.x.assign(b.size(), 0.0);
  const double norm_b = std::sqrt(dot(b, b));
  if (norm_b == 0) return s;
  Vector r, z(b.size(), 0.0), p(b.size(), 0.0), q(b.size(), 0.0);
  const auto residual_of = [&](const Vector& x, const Vector& rhs) {  // rhs - A x
    Vector residual;
    a.apply(x, residual);
    for (std::size_t i = 0; i < residual.size(); ++i) residual[i] = rhs[i] - residual[i];
    return residual;
  };
  deflation.lift(b, s.x);
  r = residual_of(s.x, b);
  double rho = 1;
  while (s.iterations < max_iterations && std::sqrt(dot(r, r)) > tolerance * norm_b) {
    multigrid.precondition(r, z);
    deflation.lift(residual_of(z, r), z);
    const double rho_next = dot(r, z), beta = s.iterations == 0 ? 0.0 : rho_next / rho;
    rho = rho_next;
    for (std::size_t i = 0; i < p.size(); ++i) p[i] = z[i] + beta * p[i];
    a.apply(p, q);
    const double alpha = rho / dot(p, q);
    for (std::size_t i = 0; i < p.size(); ++i) s.x[i] += alpha * p[i], r[i] -= alpha * q[i];
    ++s.iterations;
  }
  r = residual_of(s.x, b);
  s.relative_residual = std::sqrt(dot(r, r)) / norm_b;
  return s;
}

}  // namespace alabaster::twin

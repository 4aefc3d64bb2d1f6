// Double-precision C++ twin of the diffusion solver: the same operator, interpolation, Galerkin products, smoother,
// V-cycle and conjugate gradients as shaders/diffusion/*.comp, written to be read. Tests measure the GPU against it.
// One colour channel at a time. Arrays carry a ghost layer of zeros around the grid, so no loop asks where it ends.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "diffusion/islands.h"
#include "diffusion/smoothing.h"

namespace alabaster::twin {

using Vector = std::vector<double>;

/// Indexing of a grid with one ghost cell on every side.
struct Lattice {
  glm::ivec3 n{0};  // cells without ghosts

  std::size_t size() const { return std::size_t(n.x + 2) * (n.y + 2) * (n.z + 2); }
  std::ptrdiff_t at(glm::ivec3 c) const {
    return (c.x + 1) + std::ptrdiff_t(n.x + 2) * ((c.y + 1) + std::ptrdiff_t(n.y + 2) * (c.z + 1));
  }
  std::ptrdiff_t shift(glm::ivec3 d) const {
    return d.x + std::ptrdiff_t(n.x + 2) * (d.y + std::ptrdiff_t(n.y + 2) * d.z);
  }
  bool inside(glm::ivec3 c) const {
    return glm::all(glm::greaterThanEqual(c, glm::ivec3(0))) && glm::all(glm::lessThan(c, n));
  }
  Lattice coarser() const { return {(n + 1) / 2}; }
};

/// Offset of stencil entry k = 0..26 (x fastest); 13 is the cell itself, 26 - k the opposite one.
inline glm::ivec3 offset(int k) { return {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1}; }
inline int entry(glm::ivec3 d) { return (d.x + 1) + 3 * (d.y + 1) + 9 * (d.z + 1); }
inline constexpr int diagonal = 13;
inline constexpr int low_face[3] = {12, 10, 4};  // entries of the neighbours at -x, -y, -z

/// A symmetric operator with at most 27 points: a[k][i] = A(i, i + offset(k)) for k <= 13; the rest by symmetry.
struct Operator {
  Lattice grid;
  std::vector<int> couplings;  // the k < 13 that may be nonzero: three on the finest level, thirteen below
  std::array<Vector, 14> a;    // unused ones are empty

  static Operator seven_point(glm::ivec3 n);
  double coupling(std::ptrdiff_t i, glm::ivec3 d) const;  // A(i, i + d) for any d in {-1, 0, 1}^3
  void apply(const Vector& x, Vector& y) const;           // y = A x
  /// Reciprocal of a_ii + sum_j |a_ij|: with it the spectrum of the scaled operator lies in (0, 1]. 0 where inactive.
  Vector inverse_l1() const;
};

/// Operator-dependent interpolation (Dendy's black-box multigrid): p[k][I] = weight of coarse I in fine 2 I +
/// offset(k).
struct Interpolation {
  Lattice fine, coarse;
  std::array<Vector, 27> p;

  explicit Interpolation(const Operator& a);
  void prolong_add(const Vector& e, Vector& x) const;  // x += P e
  void restrict_to(const Vector& r, Vector& b) const;  // b = P^T r
  Operator galerkin(const Operator& a) const;          // P^T A P
};

struct Level {
  Operator a;
  Operator rounded;  // what the cycle applies in place of a, where the device's has fewer digits; empty: a itself
  Vector inverse_l1;
  Vector x, b, r;
  const Operator& in_cycle() const { return rounded.couplings.empty() ? a : rounded; }
};

/// Symmetric V-cycle: a preconditioner for conjugate gradients.
class Multigrid {
 public:
  Multigrid(Operator finest, CycleOptions options = {});
  void precondition(const Vector& r, Vector& z);  // z = M r
  const Operator& finest() const { return levels_.front().a; }
  const std::vector<Level>& levels() const { return levels_; }
  const std::vector<Interpolation>& interpolations() const { return interpolations_; }
  /// The cycle smooths level l with `rounded` and `inverse_l1` from now on.
  void smooth_with(std::size_t l, Operator rounded, Vector inverse_l1);

 private:
  void cycle(std::size_t l);
  void smooth(Level& level, bool from_zero);
  void factor_coarsest();

  CycleOptions options_;
  std::vector<double> omegas_;
  std::vector<Level> levels_;
  std::vector<Interpolation> interpolations_;
  std::vector<std::ptrdiff_t> coarsest_cells_;
  Vector coarsest_inverse_;  // dense, of the active cells
};

/// The factors of x += omega D^-1 (b - A x) that make `steps` steps the Chebyshev iteration of [lowest, 1].
std::vector<double> chebyshev_omegas(int steps, double lowest);

/// A seven-point operator as the device holds it (shared/diffusion.h), in single precision.
std::vector<float> stencil_of(const Operator& a);

/// The islands of a seven-point operator (islands.h): Z E^-1 Z^T, E = Z^T A Z.
class Deflation {
 public:
  explicit Deflation(const Operator& a);
  void lift(const Vector& r, Vector& z) const;  // z += Z E^-1 Z^T r
  std::size_t count() const { return islands_.size(); }

 private:
  struct Island {
    std::vector<std::ptrdiff_t> cells;
    double energy = 0;
  };
  std::vector<Island> islands_;
};

/// Conjugate gradients, preconditioned by the V-cycle and deflated by the islands of its finest operator.
struct Solution {
  Vector x;
  int iterations = 0;
  double relative_residual = 0;  // |b - A x| / |b|, computed from x
};
Solution solve_pcg(Multigrid& multigrid, const Vector& b, double tolerance, int max_iterations);

double dot(const Vector& a, const Vector& b);

}  // namespace alabaster::twin

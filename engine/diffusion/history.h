// Where to start from when the light has moved: the best that the solutions of before can say together (Fischer 1998,
// "Projection techniques for iterative solution of Ax = b with successive right-hand sides"). They are kept
// A-orthogonal, v_i . A v_j = 0, so that the nearest combination to the new solution, in the energy norm, is sum (v_i .
// b / v_i . A v_i) v_i: no new application of A, and no system to solve. For a light that moves steadily the first
// residual falls by orders. A new medium is another A: then all is forgotten.
#pragma once

#include <array>

#include "diffusion/pcg.h"

namespace alabaster {

class SolutionHistory {
 public:
  static constexpr int depth = 4;  // solutions kept: 16 bytes a cell and channel

  /// All outlive this.
  SolutionHistory(gpu::Context& context, const DiffusionPasses& passes, Multigrid& multigrid, Pcg& pcg);

  /// Puts the best start for pcg.rhs() into pcg.solution(); leaves it alone, and says false, where there is nothing to
  /// start from.
  bool guess();
  /// Takes in pcg.solution(), which solves pcg.rhs(), in place of the oldest.
  void add();
  void forget();

 private:
  using Sums = std::array<double, depth>;
  std::vector<Sums> products();  // v_k . rhs of each channel
  void blend(float step, const gpu::Image& x, const std::vector<glm::vec4>& coefficients, const gpu::Image& to);
  std::vector<double> energies(const gpu::Image& v);  // v . A v of each channel

  gpu::Context& context_;
  const DiffusionPasses& passes_;
  Multigrid& multigrid_;
  Pcg& pcg_;
  gpu::Image kept_[depth], product_;
  gpu::Buffer sums_, coefficients_;
  std::vector<Sums> energies_;  // v_k . A v_k of each channel; 0: none
  int next_ = 0;
};

}  // namespace alabaster

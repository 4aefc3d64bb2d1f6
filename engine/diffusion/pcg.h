// Conjugate gradients on the device, preconditioned by a V-cycle and deflated by the medium's islands (A-DEF2 in Tang,
// Nabben, Vuik, Erlangga 2009). All scalars stay there; the host reads a few floats
// after every batch of iterations.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "diffusion/multigrid.h"

namespace alabaster {

struct SolverOptions {
  // Of the true relative residual |b - A x| / |b|, and a third of that of |D^-1 (b - A x)| / |x|, D the l1 norm of the
  // rows: where some cells conduct 1e6 times worse than those that make |b|, only the latter sees their error. At 1e-6
  // the fluence agrees with double precision to 2e-4 of its largest.
  double tolerance = 1e-6;
  int max_iterations = 100;
  int batch = 1;         // iterations between two looks at the residual
  int corrections = 2;   // deferred-correction passes that make the surface second order; 0: first order
  bool history = false;  // start from the best of the solutions of before (history.h): for lights that move
  CycleOptions multigrid;
};

struct SolverStatus {
  bool converged = false;             // every channel, by its true residual
  int iterations = 0;                 // of the slowest channel
  double relative_residual[3] = {0};  // true: |b - A x| / |b|, 0 where b = 0
  double scaled_residual[3] = {0};    // true: |D^-1 (b - A x)| / |x|, 0 where b = 0
  double began_at = 0;                // the first relative residual, of the worst channel
  std::string reason;                 // when not converged: one line, with the remedy
};

/// What a solve is to reach.
struct SolverGoal {
  double tolerance = 0;        // of the residuals; 0: SolverOptions::tolerance
  bool by_recurrence = false;  // what the conjugate gradients themselves say of |b - A x| / |b| is enough
  // Where the first relative residual is above `near`, what comes out is not the last word: `first` by recurrence will
  // do.
  double near = INFINITY, first = 0;
};

class Pcg {
 public:
  /// `multigrid` is set up by the caller before solve(), and outlives this.
  Pcg(gpu::Context& context, const DiffusionPasses& passes, Multigrid& multigrid, const SolverOptions& options = {});

  /// Solves A x = b for the images rhs() and solution(), starting from what solution() holds.
  SolverStatus solve(SolverGoal goal = {});

  /// Forgets the solution: the next solve() starts from zero.
  void clear_solution();

  gpu::Image& rhs() { return rhs_; }
  gpu::Image& solution() { return high_; }      // x, to single precision
  gpu::Image& solution_rest() { return low_; }  // x = solution + rest is what the residual is computed from
  const gpu::Buffer& partials() const { return partials_; }
  /// How many partial sums a pass leaves that goes by bricks.
  int partials_per_channel() const { return multigrid_.bricks().count; }

 private:
  void record();
  void record_start();
  void record_residual(gpu::Commands& commands);
  void record_islands(gpu::Commands& commands, bool start, const gpu::Image& z);
  void record_batch();
  void reduce(gpu::Commands& commands, int mode, const BrickList& list, int sum = 0);
  std::vector<CgScalars> scalars() const;
  bool converged_by_recurrence(SolverStatus& status) const;

  gpu::Context& context_;
  const DiffusionPasses& passes_;
  Multigrid& multigrid_;
  SolverOptions options_;
  gpu::Image rhs_, high_, low_, p_;
  gpu::Buffer partials_, scalars_;
  std::unique_ptr<gpu::Commands> start_, batch_;
  int recorded_ = 0;  // the multigrid's generation: a new medium has new islands
};

}  // namespace alabaster

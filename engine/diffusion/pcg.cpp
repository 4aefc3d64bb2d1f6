#include "diffusion/pcg.h"

#include <algorithm>
#include <cmath>

namespace alabaster {
namespace {

constexpr double noisy_share = 0.05;  // of the cells (Islands::noise); media of sharp parts have 0.02

}  // namespace

Pcg::Pcg(gpu::Context& context, const DiffusionPasses& passes, Multigrid& multigrid, const SolverOptions& options)
    : context_(context), passes_(passes), multigrid_(multigrid), options_(options) {
  const glm::ivec3 cells = multigrid.finest().cells;
  for (gpu::Image* v : {&rhs_, &high_, &low_, &p_})
    *v = packed_image(context, cells, multigrid.channels(), 1, "vector");
  partials_ = gpu::Buffer(context, std::size_t(3) * multigrid.channels() * partials_per_channel() * sizeof(float),
                          "diffusion partials");
  scalars_ = gpu::Buffer(context, multigrid.channels() * sizeof(CgScalars), "diffusion scalars", gpu::Memory::host);
  gpu::Commands commands(context);
  commands.fill(partials_);
  commands.submit();
}

// `list`: by what the pass before went; `sum`: which of the sums that it left.
void Pcg::reduce(gpu::Commands& commands, int mode, const BrickList& list, int sum) {
  const int channels = multigrid_.channels(), partials = list.count;
  commands.dispatch(passes_.reduce, {64 * channels, 1, 1}, {{"partials", partials_}, {"scalars", scalars_}},
                    ReducePush{partials, mode, sum * channels * partials});
}

void Pcg::record() {
  record_start();
  record_batch();
  recorded_ = multigrid_.generation();
}

// r = b - A (high + low), the first smoothing step of a cycle, and three sums: r . r, |D^-1 r|^2, |x|^2
void Pcg::record_residual(gpu::Commands& commands) {
  MultigridLevel& level = multigrid_.finest();
  const LevelPush push{level.cells, level.cells, multigrid_.first_omega()};
  commands.dispatch(passes_.start, multigrid_.column_threads(),
                    {{"bricks", multigrid_.columns().packed},
                     {"stencil", level.stencil},
                     {"x", high_},
                     {"rest", low_},
                     {"partials", partials_},
                     {"inverse_l1", level.inverse_l1},
                     {"b", rhs_},
                     {"r", level.b},
                     {"z", level.x}},
                    push);
}

// c = E^-1 Z^T (r - A z), or E^-1 Z^T r
void Pcg::record_islands(gpu::Commands& commands, bool start, const gpu::Image& z) {
  const Deflation& deflation = multigrid_.deflation();
  commands.dispatch(passes_.islands[start], {8 * std::min(deflation.pieces(), 65535u), 1, 1},
                    {{"pieces", deflation.piece_list()},
                     {"entries", deflation.entries()},
                     {"sums", deflation.sums()},
                     {"r", multigrid_.finest().b},
                     {"z", z},
                     {"stencil", multigrid_.finest().stencil}},
                    IslandPush{multigrid_.finest().cells, deflation.pieces()});
  commands.dispatch(passes_.lifts, {deflation.count(), 1, 1},
                    {{"islands", deflation.pieces_of()}, {"sums", deflation.sums()}, {"lifts", deflation.lifts()}},
                    LiftPush{static_cast<std::uint32_t>(deflation.count())});
}

void Pcg::record_start() {
  MultigridLevel& level = multigrid_.finest();
  const Deflation& deflation = multigrid_.deflation();
  const glm::uvec3 threads = multigrid_.threads(0);
  const LevelPush push{level.cells, level.cells, 0};
  start_ = std::make_unique<gpu::Commands>(context_);
  const auto scope = start_->time("diffusion residual");
  start_->dispatch(passes_.norm, threads,
                   {{"bricks", multigrid_.bricks().packed}, {"partials", partials_}, {"x", rhs_}}, push);
  reduce(*start_, DIFFUSION_REDUCE_START, multigrid_.bricks());
  record_residual(*start_);
  if (deflation.count() > 0) {  // x += Z E^-1 Z^T r
    record_islands(*start_, true, level.x);
    start_->dispatch(passes_.lift, threads,
                     {{"bricks", multigrid_.bricks().packed},
                      {"labels", deflation.labels()},
                      {"lifts", deflation.lifts()},
                      {"high", high_},
                      {"low", low_}},
                     push);
    record_residual(*start_);
  }
  reduce(*start_, DIFFUSION_REDUCE_SCALED, multigrid_.columns(), 1);
  reduce(*start_, DIFFUSION_REDUCE_SIZE, multigrid_.columns(), 2);
  reduce(*start_, DIFFUSION_REDUCE_TRUE, multigrid_.columns());
}

void Pcg::record_batch() {
  MultigridLevel& level = multigrid_.finest();
  const Deflation& deflation = multigrid_.deflation();
  const bool deflated = deflation.count() > 0;
  const gpu::Buffer& bricks = multigrid_.bricks().packed;
  const glm::uvec3 threads = multigrid_.threads(0);
  const LevelPush push{level.cells, level.cells, multigrid_.first_omega()};
  batch_ = std::make_unique<gpu::Commands>(context_);
  gpu::Commands& commands = *batch_;
  const auto scope = commands.time("diffusion iterations");
  for (int i = 0; i < options_.batch; ++i) {
    const gpu::Image& z = multigrid_.record_cycle(commands, partials_);  // z = M r
    reduce(commands, DIFFUSION_REDUCE_BETA, multigrid_.columns());       // r . Z c = 0: z's lift adds nothing to r . z
    if (deflated) record_islands(commands, false, z);
    commands.dispatch(passes_.direction[deflated], threads,
                      {{"bricks", bricks},
                       {"scalars", scalars_},
                       {"labels", deflation.labels()},
                       {"lifts", deflation.lifts()},
                       {"z", z},
                       {"p", p_}},
                      push);
    commands.dispatch(passes_.apply_dot, multigrid_.column_threads(),  // q = A p
                      {{"bricks", multigrid_.columns().packed},
                       {"stencil", level.stencil},
                       {"x", p_},
                       {"partials", partials_},
                       {"product", level.r}},
                      push);
    reduce(commands, DIFFUSION_REDUCE_ALPHA, multigrid_.columns());
    commands.dispatch(passes_.update, threads,
                      {{"bricks", bricks},
                       {"partials", partials_},
                       {"scalars", scalars_},
                       {"inverse_l1", level.inverse_l1},
                       {"p", p_},
                       {"q", level.r},
                       {"high", high_},
                       {"low", low_},
                       {"r", level.b},
                       {"z", level.x}},
                      push);
    reduce(commands, DIFFUSION_REDUCE_RESIDUAL, multigrid_.bricks());
  }
}

std::vector<CgScalars> Pcg::scalars() const {
  const CgScalars* first = static_cast<const CgScalars*>(scalars_.mapped());
  return {first, first + multigrid_.channels()};
}

void Pcg::clear_solution() {
  gpu::Commands commands(context_);
  for (gpu::Image* v : {&high_, &low_}) commands.clear(*v);
  commands.submit();
}

bool Pcg::converged_by_recurrence(SolverStatus& status) const {
  const std::vector<CgScalars> all = scalars();
  status.converged = std::all_of(all.begin(), all.end(), [](const CgScalars& s) { return s.done == 1; });
  for (std::size_t c = 0; c < all.size(); ++c)
    status.relative_residual[c] = all[c].bb > 0 ? std::sqrt(double(all[c].rr) / all[c].bb) : 0.0;
  return status.converged;
}

// Recurrences drift from the truth in single precision. So when they claim convergence the residual is computed anew,
// and where it disagrees the gradients start again from it; only when that no longer helps does the solver give up.
SolverStatus Pcg::solve(SolverGoal goal) {
  if (goal.tolerance <= 0) goal.tolerance = options_.tolerance;
  SolverStatus status;
  if (recorded_ != multigrid_.generation()) record();
  CgScalars* const device = static_cast<CgScalars*>(scalars_.mapped());
  const auto aim = [&](double tolerance) {
    for (int c = 0; c < multigrid_.channels(); ++c)
      device[c].tolerance = device[c].target = static_cast<float>(tolerance);
  };
  aim(goal.tolerance);
  std::vector<double> last(multigrid_.channels(), INFINITY);
  while (true) {
    start_->submit();
    const std::vector<CgScalars> checked = scalars();
    bool stalled = true;
    status.converged = true;
    for (std::size_t c = 0; c < checked.size(); ++c) {
      const double relative = checked[c].bb > 0 ? std::sqrt(double(checked[c].true_rr) / checked[c].bb) : 0.0,
                   scaled = checked[c].xx > 0 ? std::sqrt(double(checked[c].scaled_rr) / checked[c].xx) : 0.0,
                   larger = std::max(relative, scaled);
      status.relative_residual[c] = relative;
      status.scaled_residual[c] = scaled;
      if (status.iterations == 0) status.began_at = std::max(status.began_at, relative);
      if (checked[c].done == 1) continue;
      status.converged = false;
      stalled = stalled && !(larger < 0.5 * last[c]);
      last[c] = larger;
      if (relative <= goal.tolerance)
        device[c].target = static_cast<float>(0.5 * relative * DIFFUSION_SCALED * goal.tolerance / scaled);
    }
    if (status.converged) return status;
    if (status.iterations == 0 && status.began_at > goal.near) {
      goal = {goal.first, true};
      aim(goal.tolerance);
    }
    const double noise = multigrid_.deflation().noise();
    const bool given_up = status.iterations >= options_.max_iterations;
    if ((stalled || given_up) && noise > noisy_share) {
      status.reason =
          "no convergence in " + std::to_string(status.iterations) +
          " iterations: " + std::to_string(std::lround(100 * noise)) +
          " % of the cells lie between neighbours of three orders of magnitude, which is noise at the scale "
          "of a cell; contrasts to 1e4 are supported there; smooth the medium, or use a finer grid";
      return status;
    }
    if (stalled) {
      status.reason =
          "the residual stopped falling: single precision cannot resolve this contrast of coefficients; use a "
          "looser tolerance, or a finer grid where the medium changes from cell to cell";
      return status;
    }
    if (given_up) {
      status.reason = "no convergence in " + std::to_string(status.iterations) +
                      " iterations: the medium changes by orders "
                      "of magnitude from cell to cell; use a finer grid or smooth the medium";
      return status;
    }
    bool done = false;
    int taken = 0;
    for (; !done && status.iterations + taken < options_.max_iterations;) {
      batch_->submit();
      done = true;
      taken = 0;
      for (const CgScalars& s : scalars()) {
        done = done && s.done != 0;
        taken = std::max(taken, s.iterations);
      }
    }
    status.iterations += taken;
    if (goal.by_recurrence && converged_by_recurrence(status)) return status;
  }
}

}  // namespace alabaster

#include "diffusion/multigrid.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "diffusion/dense.h"

namespace alabaster {

DiffusionPasses::DiffusionPasses(gpu::Context& c)
    : diagonals{{c, "diffusion/diagonals.comp", {0}}, {c, "diffusion/diagonals.comp", {1}}},
      pack{c, "diffusion/pack.comp", {1}},
      drift{c, "diffusion/drift.comp", {1}},
      rough{c, "diffusion/rough.comp", {1}},
      weights{{c, "diffusion/weights.comp", {0}}, {c, "diffusion/weights.comp", {1}}},
      deficits{{c, "diffusion/deficits.comp", {0}}, {c, "diffusion/deficits.comp", {1}}},
      galerkin{{c, "diffusion/galerkin.comp", {0, 0}}, {c, "diffusion/galerkin.comp", {1, 0}}},
      galerkin_own_row{{c, "diffusion/galerkin.comp", {0, 1}}, {c, "diffusion/galerkin.comp", {1, 1}}},
      smooth{{c, "diffusion/smooth.comp", {0, 0}}, {c, "diffusion/smooth.comp", {1, 0}}},
      smooth_dot{c, "diffusion/smooth.comp", {1, 1}},
      defect{{c, "diffusion/defect.comp", {0}}, {c, "diffusion/defect.comp", {1}}},
      residual{{c, "diffusion/residual.comp", {0}}, {c, "diffusion/residual.comp", {1}}},
      restrict_residual{c, "diffusion/restrict.comp"},
      prolong{c, "diffusion/prolong.comp"},
      direct{c, "diffusion/direct.comp"},
      apply_dot{c, "diffusion/apply_dot.comp", {1}},
      norm{c, "diffusion/norm.comp", {1}},
      update{c, "diffusion/update.comp", {1}},
      start{c, "diffusion/start.comp", {1}},
      direction{{c, "diffusion/direction.comp", {1, 0}}, {c, "diffusion/direction.comp", {1, 1}}},
      reduce{c, "diffusion/reduce.comp"},
      project{c, "diffusion/project.comp", {1}},
      blend{c, "diffusion/blend.comp", {1}},
      islands{{c, "diffusion/islands.comp", {0}}, {c, "diffusion/islands.comp", {1}}},
      lifts{c, "diffusion/lifts.comp"},
      lift{c, "diffusion/lift.comp", {1}} {}

std::vector<float> chebyshev_omegas(int steps, double lowest) {
  std::vector<float> omegas;
  for (int k = 0; k < steps; ++k) {
    const double root = std::cos(std::numbers::pi * (k + 0.5) / steps);
    omegas.push_back(static_cast<float>(2 / ((1 + lowest) + (1 - lowest) * root)));
  }
  return omegas;
}

gpu::Image packed_image(gpu::Context& context, glm::ivec3 cells, int channels, int entries, const std::string& name,
                        VkFormat format) {
  gpu::Image image =
      gpu::image3d(context, {(cells.x + 3) / 4 * entries, cells.y, cells.z * channels}, format, "diffusion " + name);
  gpu::Commands commands(context);
  commands.clear(image);
  commands.submit();
  return image;
}

namespace {

// Coarse cells with a cell of the finer level within reach of their interpolation.
std::vector<std::uint8_t> coarser(glm::ivec3 n, const std::vector<std::uint8_t>& active) {
  const glm::ivec3 m = (n + 1) / 2;
  std::vector<std::uint8_t> result(std::size_t(m.x) * m.y * m.z);
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x) {
        if (!active[x + std::size_t(n.x) * (y + std::size_t(n.y) * z)]) continue;
        const glm::ivec3 low = glm::ivec3(x, y, z) / 2, high = glm::min((glm::ivec3(x, y, z) + 1) / 2, m - 1);
        for (int k = low.z; k <= high.z; ++k)
          for (int j = low.y; j <= high.y; ++j)
            for (int i = low.x; i <= high.x; ++i) result[i + std::size_t(m.x) * (j + std::size_t(m.y) * k)] = 1;
      }
  return result;
}

}  // namespace

Multigrid::Multigrid(gpu::Context& context, const DiffusionPasses& passes, glm::ivec3 cells, int channels,
                     std::vector<std::uint8_t> active, const CycleOptions& options)
    : context_(context), passes_(passes), channels_(channels), options_(options) {
  // Columns save a CPU work; a GPU wants threads more.
  columns_ = make_columns(context, cells, active, context.info().kind == "CPU" ? DIFFUSION_COLUMN_BRICKS : 2);
  for (bool last = false; !last; cells = (cells + 1) / 2) {
    last = !levels_.empty() && cells.x * cells.y * cells.z <= options.direct_cells;
    MultigridLevel level;
    level.cells = cells;
    level.bricks = make_bricks(context, cells, active);
    if (!last) active = coarser(cells, active);
    const int entries = levels_.empty() ? DIFFUSION_FINEST_ENTRIES : DIFFUSION_COARSE_ENTRIES;
    level.stencil = packed_image(context, cells, channels, entries, "stencil");
    level.inverse_l1 = packed_image(context, cells, channels, 1, "inverse l1");
    if (!last) level.weights = packed_image(context, (cells + 1) / 2, channels, DIFFUSION_WEIGHTS, "weights");
    for (gpu::Image* v : {&level.b, &level.x, &level.spare, &level.r})
      *v = packed_image(context, cells, channels, 1, "vector");
    levels_.push_back(std::move(level));
  }
  pairs_ = packed_image(context, levels_[0].cells, channels, DIFFUSION_PAIRS, "pairs", VK_FORMAT_R32G32B32A32_UINT);
  const MultigridLevel& coarsest = levels_.back();
  const std::size_t padded = std::size_t(4) * coarsest.texels_x() * coarsest.cells.y * coarsest.cells.z;
  roughness_ = gpu::Buffer(context, channels * sizeof(Roughness), "diffusion roughness", gpu::Memory::host);
  inverse_ = gpu::Buffer(context, channels * padded * padded * sizeof(float), "diffusion coarsest inverse");
}

glm::uvec3 Multigrid::threads(std::size_t l) const { return {levels_[l].bricks.count * 8, channels_, 1}; }
glm::uvec3 Multigrid::column_threads() const { return {columns_.count * 8, channels_, 1}; }

LevelPush Multigrid::push(std::size_t l, float omega) const {
  return {levels_[l].cells, levels_[std::min(l + 1, levels_.size() - 1)].cells, omega};
}

void Multigrid::release() {
  for (MultigridLevel& level : levels_) {
    MultigridLevel rest;
    rest.cells = level.cells;
    rest.bricks = std::move(level.bricks);
    level = std::move(rest);
  }
  pairs_ = {};
  inverse_ = {};
  roughness_ = {};
  deflation_ = {};
}

// Row sums and diagonals for the coarse levels' set-up, and what the cycle and the gradients read of the finest
// stencil.
void Multigrid::record_finest(gpu::Commands& commands) {
  MultigridLevel& level = finest();
  commands.dispatch(passes_.diagonals[1], threads(0),
                    {{"bricks", level.bricks.packed},
                     {"stencil", level.stencil},
                     {"inverse_l1", level.inverse_l1},
                     {"diagonal", level.spare},
                     {"row_sum", level.b}},
                    push(0));
  commands.dispatch(passes_.pack, threads(0),
                    {{"bricks", level.bricks.packed},
                     {"stencil", level.stencil},
                     {"inverse_l1", level.inverse_l1},
                     {"pairs", pairs_}},
                    push(0));
}

void Multigrid::record_roughness(gpu::Commands& commands) {
  commands.fill(roughness_);
  commands.dispatch(passes_.rough, column_threads(),
                    {{"bricks", columns_.packed}, {"stencil", finest().stencil}, {"counts", roughness_}}, push(0));
}

double Multigrid::drift() {
  const gpu::Buffer factors(context_, std::size_t(channels_) * bricks().count * sizeof(float), "diffusion drift");
  gpu::Commands commands(context_);
  commands.fill(factors);
  commands.dispatch(
      passes_.drift, threads(0),
      {{"bricks", bricks().packed}, {"stencil", finest().stencil}, {"factors", factors}, {"pairs", pairs_}}, push(0));
  commands.submit();
  const std::vector<float> all = gpu::download<float>(context_, factors);
  return *std::max_element(all.begin(), all.end());
}

void Multigrid::refresh() {
  if (generation_ > 0 && deflation_.count() == 0) drifted_ *= drift();
  if (generation_ == 0 || deflation_.count() > 0 || !(drifted_ <= kept_within)) return set_up();
  gpu::Commands commands(context_);
  record_finest(commands);
  commands.submit();
}

void Multigrid::set_up() {
  gpu::Commands commands(context_);
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    const auto scope = commands.time("diffusion hierarchy");
    const bool finest = l == 0;
    MultigridLevel& level = levels_[l];
    if (finest) {
      record_finest(commands);
      record_roughness(commands);
    } else
      commands.dispatch(passes_.diagonals[0], threads(l),
                        {{"bricks", level.bricks.packed},
                         {"stencil", level.stencil},
                         {"inverse_l1", level.inverse_l1},
                         {"diagonal", level.spare},
                         {"row_sum", level.b}},
                        push(l));
    if (l + 1 == levels_.size()) break;
    const MultigridLevel& coarse = levels_[l + 1];
    int first = 0;
    for (const int count : {1, 6, 12, 8}) {  // entries with 0 to 3 odd coordinates
      commands.dispatch(passes_.weights[finest], {coarse.bricks.count * 8, channels_, count},
                        {{"bricks", coarse.bricks.packed},
                         {"stencil", level.stencil},
                         {"diagonal", level.spare},
                         {"weights", level.weights}},
                        WeightsPush{level.cells, coarse.cells, first});
      first += count;
    }
    record_row_sums(commands, l);
    const auto galerkin = [&](const gpu::Pass& pass, std::uint32_t groups) {
      commands.dispatch(pass, {coarse.bricks.count * 8, channels_, groups},
                        {{"bricks", coarse.bricks.packed},
                         {"stencil", level.stencil},
                         {"diagonal", level.spare},
                         {"weights", level.weights},
                         {"row_sums", coarse.b},
                         {"coarse_stencil", coarse.stencil}},
                        push(l));
    };
    commands.concurrent([&] {
      galerkin(passes_.galerkin[finest], 4);
      galerkin(passes_.galerkin_own_row[finest], 1);
    });
  }
  commands.submit();
  invert_coarsest();
  deflation_ = Deflation(context_, finest().stencil, finest().cells, gpu::download<Roughness>(context_, roughness_));
  const Smoothing& smoothing = deflation_.rough() ? options_.rough : options_.even;
  omegas_ = chebyshev_omegas(smoothing.sweeps, smoothing.lowest);
  drifted_ = 1;
  ++generation_;
}

// The row sums of the next coarser operator, P^T (A 1 - A v) with v = 1 - P 1, into its b; level.b holds A 1.
void Multigrid::record_row_sums(gpu::Commands& commands, std::size_t l) {
  const bool finest = l == 0;
  MultigridLevel &level = levels_[l], &coarse = levels_[l + 1];
  const gpu::Image *v = &level.x, *next = &level.r;
  commands.clear(level.x);
  for (int odd = 1; odd <= 3; ++odd) {
    commands.dispatch(passes_.deficits[finest], threads(l),
                      {{"bricks", level.bricks.packed},
                       {"stencil", level.stencil},
                       {"diagonal", level.spare},
                       {"before", *v},
                       {"after", *next}},
                      push(l));
    std::swap(v, next);
  }
  commands.dispatch(
      passes_.residual[finest], threads(l),
      {{"bricks", level.bricks.packed}, {"stencil", level.stencil}, {"x", *v}, {"b", level.b}, {"residual", *next}},
      push(l));
  commands.dispatch(passes_.restrict_residual, threads(l + 1),
                    {{"bricks", coarse.bricks.packed},
                     {"residual", *next},
                     {"weights", level.weights},
                     {"inverse_l1", coarse.inverse_l1},
                     {"b", coarse.b},
                     {"x", coarse.x}},
                    push(l));
}

// The coarsest operator is tiny: its inverse is made in double precision on the CPU. Single precision made the
// operator, so pivots below its rounding mean nothing.
void Multigrid::invert_coarsest() {
  const MultigridLevel& level = levels_.back();
  const std::vector<float> stencil = gpu::download<float>(context_, level.stencil);
  const glm::ivec3 n = level.cells, padded{4 * level.texels_x(), n.y, n.z};
  const int cells = padded.x * n.y * n.z;
  auto entry = [&](glm::ivec3 c, int k, int channel) {
    return stencil[padded.x * DIFFUSION_COARSE_ENTRIES * (c.y + std::size_t(n.y) * (c.z + channel * n.z)) +
                   k * padded.x + c.x];
  };
  std::vector<float> inverse(std::size_t(channels_) * cells * cells);
  tbb::parallel_for(0, channels_, [&](int channel) {
    std::vector<double> dense(std::size_t(cells) * cells, 0.0);
    for (int row = 0; row < cells; ++row) {
      const glm::ivec3 c{row % padded.x, row / padded.x % padded.y, row / (padded.x * padded.y)};
      dense[std::size_t(row) * (cells + 1)] += entry(c, DIFFUSION_ROW_SUM, channel);
      for (int k = 0; k < DIFFUSION_ROW_SUM; ++k) {
        const glm::ivec3 d{k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1}, other = c + d;
        if (glm::any(glm::lessThan(other, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(other, padded))) continue;
        const int column = other.x + padded.x * (other.y + padded.y * other.z);
        const double coupling = entry(c, k, channel);
        dense[std::size_t(row) * cells + column] = dense[std::size_t(column) * cells + row] = coupling;
        dense[std::size_t(row) * (cells + 1)] -= coupling;
        dense[std::size_t(column) * (cells + 1)] -= coupling;
      }
    }
    const std::vector<double> exact = invert_spd(std::move(dense), cells, 1e-6);
    std::transform(exact.begin(), exact.end(), inverse.begin() + channel * exact.size(),
                   [](double v) { return static_cast<float>(v); });
  });
  gpu::upload(context_, inverse_, inverse);
}

void Multigrid::record_smooth(gpu::Commands& commands, std::size_t l, const gpu::Pass& pass, float omega,
                              const gpu::Image& from, const gpu::Image& to, const gpu::Buffer& partials) {
  const MultigridLevel& level = levels_[l];
  commands.dispatch(pass, walkers(l),
                    {{"bricks", walked(l).packed},
                     {"stencil", level.stencil},
                     {"inverse_l1", level.inverse_l1},
                     {"pairs", pairs_},
                     {"x", from},
                     {"partials", partials},
                     {"b", level.b},
                     {"smoothed", to}},
                    push(l, omega));
}

const gpu::Image& Multigrid::record_cycle(gpu::Commands& commands, const gpu::Buffer& partials) {
  return record_level(commands, 0, partials);
}

const gpu::Image& Multigrid::record_level(gpu::Commands& commands, std::size_t l, const gpu::Buffer& partials) {
  const MultigridLevel& level = levels_[l];
  if (l + 1 == levels_.size()) {  // x = A^-1 b
    commands.dispatch(passes_.direct, {level.texels_x() * level.cells.y * level.cells.z, channels_, 1},
                      {{"inverse", inverse_}, {"b", level.b}, {"x", level.x}}, push(l));
    return level.x;
  }
  const bool finest = l == 0;
  const gpu::Image *x = &level.x, *spare = &level.spare;   // x: the first smoothing step of b
  auto smooth = [&](const gpu::Pass& pass, float omega) {  // x += omega D^-1 (b - A x)
    record_smooth(commands, l, pass, omega, *x, *spare, partials);
    std::swap(x, spare);
  };
  for (std::size_t s = 1; s < omegas_.size(); ++s) smooth(passes_.smooth[finest], omegas_[s]);
  commands.dispatch(passes_.defect[finest], walkers(l),  // r = b - A x
                    {{"bricks", walked(l).packed},
                     {"stencil", level.stencil},
                     {"inverse_l1", level.inverse_l1},
                     {"pairs", pairs_},
                     {"x", *x},
                     {"b", level.b},
                     {"defect", level.r}},
                    push(l));
  const MultigridLevel& coarse = levels_[l + 1];
  commands.dispatch(passes_.restrict_residual, threads(l + 1),  // b' = P^T r
                    {{"bricks", coarse.bricks.packed},
                     {"residual", level.r},
                     {"weights", level.weights},
                     {"inverse_l1", coarse.inverse_l1},
                     {"b", coarse.b},
                     {"x", coarse.x}},
                    push(l, omegas_.front()));
  const gpu::Image& correction = record_level(commands, l + 1, partials);
  commands.dispatch(
      passes_.prolong, threads(l + 1),  // x += P x'
      {{"bricks", coarse.bricks.packed}, {"weights", level.weights}, {"correction", correction}, {"x", *x}}, push(l));
  for (std::size_t s = omegas_.size(); s-- > 0;)
    smooth(finest && s == 0 ? passes_.smooth_dot : passes_.smooth[finest], omegas_[s]);
  return *x;
}

}  // namespace alabaster

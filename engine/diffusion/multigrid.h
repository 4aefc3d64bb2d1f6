// Geometric multigrid on 3D images: black-box interpolation, Galerkin coarse operators, Chebyshev smoothing. One
// V-cycle is a symmetric positive definite preconditioner. Knows no lights and no cut cells: the finest stencil is
// given.
#pragma once

#include <vector>

#include "diffusion/bricks.h"
#include "diffusion/deflation.h"
#include "diffusion/smoothing.h"
#include "gpu/commands.h"
#include "shared/diffusion.h"

namespace alabaster {

/// The solver's pipelines, made once a context.
struct DiffusionPasses {
  explicit DiffusionPasses(gpu::Context& context);
  gpu::Pass diagonals[2], pack, drift, rough, weights[2], deficits[2], galerkin[2], galerkin_own_row[2];  // [finest]
  gpu::Pass smooth[2], smooth_dot, defect[2], residual[2], restrict_residual, prolong, direct;
  gpu::Pass apply_dot, norm, update, start, direction[2], reduce;  // direction[deflated]
  gpu::Pass project, blend;                                        // history.h
  gpu::Pass islands[2], lifts, lift;                               // islands[start]
};

/// Factors of x += omega D^-1 (b - A x) that make `steps` such steps the Chebyshev iteration of [lowest, 1].
std::vector<float> chebyshev_omegas(int steps, double lowest);

struct MultigridLevel {
  glm::ivec3 cells{0};
  BrickList bricks;
  gpu::Image stencil;     // DIFFUSION_FINEST_ENTRIES or DIFFUSION_COARSE_ENTRIES along x
  gpu::Image inverse_l1;  // reciprocal l1 norm of the rows
  gpu::Image weights;     // DIFFUSION_WEIGHTS along x, on the next coarser grid; none on the coarsest level
  gpu::Image b, x, spare, r;
  int texels_x() const { return (cells.x + 3) / 4; }
};

class Multigrid {
 public:
  /// `cells` of the finest level, x a multiple of 4, with a margin of one empty cell all around; `active`: not
  /// zero for the cells that the finest stencil has, x fastest.
  Multigrid(gpu::Context& context, const DiffusionPasses& passes, glm::ivec3 cells, int channels,
            std::vector<std::uint8_t> active, const CycleOptions& options = {});

  /// Builds everything below the finest stencil, which the caller has written, and finds its islands.
  void set_up();

  /// The same where the finest stencil was written anew; but coarse levels stay as long as no entry has come to differ
  /// by more than `kept_within` from what they were made of, and islands are none: they are a preconditioner's, and as
  /// good within that factor.
  void refresh();
  static constexpr double kept_within = 1.5;

  /// Frees all that the cycle and the set-up need; bricks stay. Neither can be asked for afterwards.
  void release();

  /// z = M r. Before: finest().b = r, finest().x = first_omega() * inverse_l1 * r. Leaves partial sums of r . z and
  /// returns the image that holds z.
  const gpu::Image& record_cycle(gpu::Commands& commands, const gpu::Buffer& partials);

  MultigridLevel& finest() { return levels_.front(); }
  std::vector<MultigridLevel>& levels() { return levels_; }
  float first_omega() const { return omegas_.front(); }
  int channels() const { return channels_; }
  const BrickList& bricks(std::size_t level = 0) const { return levels_[level].bricks; }
  /// The finest level's bricks as columns, for the passes that walk up them: smooth, defect, apply_dot and start.
  const BrickList& columns() const { return columns_; }
  const gpu::Image& pairs() const { return pairs_; }
  const Deflation& deflation() const { return deflation_; }
  int generation() const { return generation_; }  // how often it was set up
  /// Threads that cover a level by its bricks.
  glm::uvec3 threads(std::size_t level) const;
  /// The same by columns().
  glm::uvec3 column_threads() const;

 private:
  const gpu::Image& record_level(gpu::Commands& commands, std::size_t l, const gpu::Buffer& partials);
  const BrickList& walked(std::size_t l) const { return l == 0 ? columns_ : bricks(l); }
  glm::uvec3 walkers(std::size_t l) const { return l == 0 ? column_threads() : threads(l); }
  void record_smooth(gpu::Commands& commands, std::size_t l, const gpu::Pass& pass, float omega, const gpu::Image& from,
                     const gpu::Image& to, const gpu::Buffer& partials);
  LevelPush push(std::size_t l, float omega = 0) const;
  void record_finest(gpu::Commands& commands);
  void record_roughness(gpu::Commands& commands);
  double drift();
  void record_row_sums(gpu::Commands& commands, std::size_t l);
  void invert_coarsest();

  gpu::Context& context_;
  const DiffusionPasses& passes_;
  int channels_;
  CycleOptions options_;
  std::vector<float> omegas_;  // factors of the smoothing steps
  std::vector<MultigridLevel> levels_;
  BrickList columns_;
  gpu::Image pairs_;  // the finest stencil for the cycle: DIFFUSION_PAIRS along x
  gpu::Buffer inverse_, roughness_;
  Deflation deflation_;
  int generation_ = 0;
  double drifted_ = 1;  // at most, from the finest stencil that the coarse levels were made of
};

/// A zero-filled image for `cells` cells, `entries` a cell, of texels of four words.
gpu::Image packed_image(gpu::Context& context, glm::ivec3 cells, int channels, int entries, const std::string& name,
                        VkFormat format = VK_FORMAT_R32G32B32A32_SFLOAT);

}  // namespace alabaster

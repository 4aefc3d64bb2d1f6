// The exit of `--transport gather`: radiance gathered along the refracted view ray, its level set by the flux that the
// diffusion equation sends out around (gather_levels.h). So the diffusion equation keeps the energy, and the gather
// says where and in which direction light leaves: where the medium changes within a mean free path it knows better.
#pragma once

#include <optional>

#include "diffusion/diffusion.h"
#include "lighting/beam_source.h"
#include "lighting/ray_tree.h"
#include "shading/gather_closure.h"
#include "shading/gather_levels.h"
#include "shared/gather.h"

namespace alabaster {

class GatherExit {
 public:
  GatherExit(gpu::Context& context, const Domain& domain, const Diffusion& diffusion, const BeamSource& beam,
             const DeviceRayTree& rays, double eta);

  /// After the solve: beams' fluence and the levels (stage "gather levels").
  void update();

  /// Of the last update.
  const GatherLevels& levels() const { return *levels_; }

  /// phi_b of what beams scatter below the facets' skin, W/m^2; what they scatter in it, of side 0 or 1, W/m^2, and its
  /// mean cosine; GatherFlux of the sides k * stride().
  const gpu::Image& fluence() const { return fluence_; }
  const gpu::Image& near(int side) const { return near_[side]; }
  /// What spreading both adds to the fluence (shaders/shading/beam_shift.comp), W/m^2.
  const gpu::Image& shift() const { return shift_; }
  /// Of both, per channel, the share that no surface has sent (1: all): what of them is single scattering.
  const gpu::Image& unscattered() const { return unscattered_; }
  const gpu::Buffer& fluxes() const { return fluxes_; }
  std::uint32_t stride() const { return push_.stride; }

  /// What shading/gathered.comp needs beside the picture's own.
  gpu::Bindings picture_bindings() const;

 private:
  gpu::Bindings ray_bindings() const;
  void spread_beams(gpu::Commands& commands);

  gpu::Context& context_;
  const Domain& domain_;
  const Diffusion& diffusion_;
  const BeamSource& beam_;
  const DeviceRayTree& rays_;
  GatherLevelPush push_;
  std::vector<GatherPlace> places_;  // those asked
  float edge_;                       // of the levels, cells
  GatherClosures closures_;
  gpu::Pass fluence_pass_, beam_spread_pass_, beam_shift_pass_, spread_pass_, unscattered_pass_, level_pass_;
  gpu::Sampler linear_;
  gpu::Buffer grid_, fluxes_;
  gpu::Image fluence_, shift_, spread_, near_[2], unscattered_, level_image_;
  std::optional<GatherLevels> levels_;
};

}  // namespace alabaster

// The exit of `--transport gather`: radiance gathered along the refracted view ray, its level on each facet set by the
// flux that the diffusion equation sends out there. So the diffusion equation keeps the energy, and the gather says in
// which direction.
#pragma once

#include "diffusion/diffusion.h"
#include "lighting/beam_source.h"
#include "lighting/ray_tree.h"
#include "shared/gather.h"

namespace alabaster {

class GatherExit {
 public:
  GatherExit(gpu::Context& context, const Domain& domain, const Diffusion& diffusion, const BeamSource& beam,
             const DeviceRayTree& rays, double eta);

  /// After the solve: densities and levels (stage "gather levels").
  void record(gpu::Commands& commands) const;

  /// Sides of facets whose light was gathered in the last record() that has run, and those whose level was bounded.
  struct Counts {
    std::uint32_t sides = 0, bounded = 0;
  };
  Counts counts() const;

  /// What shading/gathered.comp needs beside the picture's own.
  gpu::Bindings picture_bindings() const;
  /// Levels of the facets' two sides, to be sampled on the surface.
  const gpu::Image& level(int side) const { return level_[side]; }

 private:
  gpu::Bindings ray_bindings() const;
  void record_spread(gpu::Commands& commands, const gpu::Buffer& values, const gpu::Image* images) const;

  const Domain& domain_;
  const Diffusion& diffusion_;
  const BeamSource& beam_;
  const DeviceRayTree& rays_;
  GatherPicturePush push_;
  gpu::Pass density_pass_, spread_pass_, level_pass_, ratio_pass_;
  gpu::Sampler linear_;
  gpu::Buffer grid_, fluxes_, levels_, counts_;
  gpu::Image density_, near_[2], level_[2];
};

}  // namespace alabaster

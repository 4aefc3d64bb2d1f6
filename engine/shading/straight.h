// What is seen straight through a translucent object, where light that goes through unscattered is not in its fluence
// (transports with beams).
#pragma once

#include "diffusion/diffusion.h"
#include "shared/gather.h"

namespace alabaster {

class Straight {
 public:
  /// The references outlive this.
  Straight(gpu::Context& context, const Domain& domain, const Diffusion& diffusion, double eta);

  /// What shading/straight.comp needs beside what reflection.comp does.
  gpu::Bindings bindings() const;

 private:
  const Domain& domain_;
  const Diffusion& diffusion_;
  gpu::Buffer grid_;
};

/// The grid of a domain and its medium, as rays cross it.
GatherGrid ray_grid(const Domain& domain, const Diffusion& diffusion, double eta);

/// What a shader that includes domain/way.glsl reads of them; `grid` is its uniform buffer.
gpu::Bindings way_bindings(const gpu::Buffer& grid, const Domain& domain, const Diffusion& diffusion);

}  // namespace alabaster

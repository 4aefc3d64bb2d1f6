#include "shading/straight.h"

#include "lighting/directional_source.h"

namespace alabaster {

GatherGrid ray_grid(const Domain& domain, const Diffusion& diffusion, double eta) {
  const SurfaceOptics optics(eta);
  return {domain.frame.cells,
          diffusion.channels(),
          domain.frame.origin,
          domain.frame.h,
          glm::vec3(diffusion.kappa_scale()),
          static_cast<float>(eta),
          static_cast<float>(optics.A),
          static_cast<float>(optics.f_dt)};
}

Straight::Straight(gpu::Context& context, const Domain& domain, const Diffusion& diffusion, double eta)
    : domain_(domain),
      diffusion_(diffusion),
      grid_(gpu::make_buffer(context, std::vector<GatherGrid>{ray_grid(domain, diffusion, eta)}, "ray grid")) {}

gpu::Bindings Straight::bindings() const {
  return {{"grid", grid_},
          {"cut_index", domain_.cut_index},
          {"cut_cells", domain_.cut_cells},
          {"volume", domain_.volume},
          {"kappa", diffusion_.kappa()},
          {"absorption", diffusion_.absorption()}};
}

}  // namespace alabaster

#include "shading/straight.h"

#include <algorithm>

#include "lighting/directional_source.h"
#include "shading/gather_closure.h"

namespace alabaster {

GatherGrid ray_grid(const Domain& domain, const Diffusion& diffusion, double eta) {
  const SurfaceOptics optics(eta);
  GatherGrid grid{domain.frame.cells,
                  diffusion.channels(),
                  domain.frame.origin,
                  domain.frame.h,
                  glm::vec3(diffusion.kappa_scale()),
                  static_cast<float>(eta),
                  static_cast<float>(optics.A),
                  static_cast<float>(optics.f_dt),
                  0,
                  1,
                  {},
                  {}};
  const GatherClosures closures(eta);
  const std::vector<glm::vec2> levels = closures.table();
  const std::vector<float> exits = closures.exits();
  std::copy(levels.begin(), levels.end(), grid.closure);
  std::copy(exits.begin(), exits.end(), grid.exit);
  return grid;
}

Straight::Straight(gpu::Context& context, const Domain& domain, const Diffusion& diffusion, double eta)
    : domain_(domain),
      diffusion_(diffusion),
      grid_(gpu::make_buffer(context, std::vector<GatherGrid>{ray_grid(domain, diffusion, eta)}, "ray grid")) {}

gpu::Bindings way_bindings(const gpu::Buffer& grid, const Domain& domain, const Diffusion& diffusion) {
  return {{"grid", grid},
          {"cut_index", domain.cut_index},
          {"cut_cells", domain.cut_cells},
          {"volume", domain.volume},
          {"kappa", diffusion.kappa()},
          {"absorption", diffusion.absorption()}};
}

gpu::Bindings Straight::bindings() const { return way_bindings(grid_, domain_, diffusion_); }

}  // namespace alabaster

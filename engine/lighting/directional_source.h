// The directional boundary source on the facets of a cut-cell domain: closed form for each light sample, no march.
#pragma once

#include "lighting/facet_receivers.h"
#include "lighting/lighting.h"

namespace alabaster {

/// The optics of a translucent object's surface.
struct SurfaceOptics {
  explicit SurfaceOptics(double eta);
  EntryPush push(std::uint32_t receivers) const;
  double eta, f_dt_outer, A, f_dt;  // index inside / outside; 1 - F_dr from outside; boundary constant; 1 - F_dr
};

class DirectionalSource {
 public:
  DirectionalSource(gpu::Context& context, const Domain& domain);

  /// Fills the buffers below. `media` holds a FacetMedium (shared/diffusion.h) a cut cell. The shadow maps of
  /// `lighting` must have been recorded before. Stage "entry".
  void record(gpu::Commands& commands, const Lighting& lighting, const gpu::Buffer& media, double eta) const;

  // W/m^2, two vec3 an entry of Domain::cut_cells: source of the boundary condition, Gamma of the render query, and all
  // that enters (shared/optics.h, directional_boundary and entering_flux).
  const gpu::Buffer& gamma_s() const { return gamma_s_; }
  const gpu::Buffer& query_gamma() const { return query_gamma_; }
  const gpu::Buffer& entered() const { return entered_; }

 private:
  FacetReceivers receivers_;
  gpu::Pass pass_;
  gpu::Buffer gamma_s_, query_gamma_, entered_;
};

}  // namespace alabaster

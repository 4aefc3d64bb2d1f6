// The directional boundary source on the facets of a cut-cell domain: closed form for each light sample, no march.
#pragma once

#include "lighting/facet_receivers.h"
#include "lighting/lighting.h"

namespace alabaster {

/// The optics of a translucent object's surface.
struct SurfaceOptics {
  explicit SurfaceOptics(double eta);
  EntryPush push(std::uint32_t receivers, SkyLinks sky) const;
  double eta, f_dt_outer, A, f_dt;  // index inside / outside; 1 - F_dr from outside; boundary constant; 1 - F_dr
};

/// What an object's facets see around them, the open environment or other surfaces (Exchange::around()); without
/// buffers the environment alone, by the lighting's shadow maps.
struct Surroundings {
  const gpu::Buffer* links = nullptr;                             // uint, [direction][side]
  const gpu::Buffer* side_of = nullptr;                           // uint an entry: side or sky_no_side
  const gpu::Buffer *transmitted = nullptr, *mirrored = nullptr;  // W/m^2/sr, of emitters
  SkyLinks shape{0, 0};
};

/// What a shader that includes lighting/arrivals.glsl needs. The receivers stand in for buffers that `around` lacks.
gpu::Bindings arrival_bindings(const Lighting& lighting, const FacetReceivers& receivers, const Surroundings& around);

class DirectionalSource {
 public:
  DirectionalSource(gpu::Context& context, const Domain& domain);

  /// Fills the buffers below. `media` holds a FacetMedium (shared/diffusion.h) a cut cell. The shadow maps of
  /// `lighting` must have been recorded before. Stage "entry".
  void record(gpu::Commands& commands, const Lighting& lighting, const gpu::Buffer& media, double eta,
              const Surroundings& around = {}) const;

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

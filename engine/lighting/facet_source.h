// Gamma_s on the facets of a cut-cell domain: the source of the diffuse field.
#pragma once

#include "domain/domain.h"
#include "gpu/commands.h"
#include "lighting/facet_receivers.h"
#include "lighting/lighting.h"

namespace alabaster {

/// Buffers of one domain's facets. Made once, refilled whenever a light moves.
class FacetSource {
 public:
  FacetSource(gpu::Context& context, const Domain& domain);

  /// Gamma_s (report, Eq. 5) of each side of each cut cell into gamma_s(). `media` holds a FacetMedium
  /// (shared/diffusion.h) a cut cell, `eta` is index inside / outside. The shadow maps of `lighting` must have been
  /// recorded before.
  void record(gpu::Commands& commands, const Lighting& lighting, const gpu::Buffer& media, double eta) const;

  /// record() in two steps, so that light from other surfaces can be added to flux() between them (exchange.h): what
  /// the lights send into direct() (the environment may be left out), copied to flux(); then Gamma_s from flux().
  void record_direct(gpu::Commands& commands, const Lighting& lighting, double eta, bool environment = true) const;
  void record_source(gpu::Commands& commands, const gpu::Buffer& media) const;

  /// W/m^2, two vec3 an entry of Domain::cut_cells, one for each side of its surface.
  const gpu::Buffer& gamma_s() const { return gamma_s_; }
  /// W/m^2 that enter, in the same form, before they are weakened by the medium.
  const gpu::Buffer& direct() const { return direct_; }
  const gpu::Buffer& flux() const { return flux_; }
  /// Receiver (shared/lighting.h) of each of them; filled by record_direct().
  const gpu::Buffer& receivers() const { return receivers_.buffer(); }
  std::uint32_t count() const { return receivers_.count(); }

 private:
  const Domain& domain_;
  FacetReceivers receivers_;
  gpu::Pass source_pass_;
  gpu::Buffer direct_, flux_, gamma_s_;
};

}  // namespace alabaster

// The volume source of refracted beams: every light sample marched from every facet into the cells.
#pragma once

#include "lighting/beam_starts.h"
#include "lighting/directional_source.h"
#include "shared/beam.h"

namespace alabaster {

/// Where a channel's light went, W: entered = near + in_cells + absorbed + through, to the last unit.
struct BeamTotals {
  glm::dvec3 entered{0};
  glm::dvec3 near{0};      // scattered so near its facet that it drives the boundary condition
  glm::dvec3 in_cells{0};  // scattered deeper
  glm::dvec3 absorbed{0};  // on the way
  glm::dvec3 through{0};   // left unscattered
};

/// The medium as the solver has it (Diffusion::kappa() and so on).
struct BeamMedium {
  const gpu::Image &kappa, &absorption;  // packed: kappa / kappa_scale, sigma_a h^2 / kappa_scale
  const gpu::Buffer& facets;             // FacetMedium a cut cell
  glm::dvec3 kappa_scale;                // m
  int channels;
};

class BeamSource {
 public:
  /// `skin`: depth below a facet down to which its light is seen only there, at least (skin_depth), h.
  BeamSource(gpu::Context& context, const Domain& domain, const BeamStarts& starts, int channels,
             float skin = float(BEAM_SKIN_DEPTH));

  /// Fills what is below. The shadow maps of `lighting` must have been recorded before. `more`: after a record()
  /// without light from surfaces adds what these send now. Stage "beams".
  void record(gpu::Commands& commands, const Lighting& lighting, const BeamMedium& medium, double eta,
              const Surroundings& around = {}, bool more = false);

  // W/m^2, two vec3 an entry of Domain::cut_cells: source of the boundary condition, Gamma of the render query, all
  // that enters; and two vec4 with what is scattered in the facet's skin and its mean cosine with the normal.
  const gpu::Buffer& gamma_s() const { return gamma_s_; }
  const gpu::Buffer& query_gamma() const { return query_gamma_; }
  const gpu::Buffer& entered() const { return entered_; }
  const gpu::Buffer& near() const { return near_; }
  float skin() const { return skin_; }
  /// W/m^2, two vec3 an entry: what leaves there unscattered, spread over the facets around that look the same way.
  const gpu::Buffer& through() const { return through_; }
  /// Scattered in the cells, W, packed like kappa; and that with what is scattered below the skin but so near its facet
  /// that it drives the boundary condition: what view rays see there.
  const gpu::Image& power() const { return power_; }
  const gpu::Image& seen() const { return seen_; }
  /// Of seen() the share that is light of lamps and the environment, and of near() all that is: no surface has sent
  /// it. The share in 255ths, packed likewise; near light as near() has it.
  const gpu::Image& unscattered() const { return unscattered_; }
  const gpu::Buffer& near_unscattered() const { return near_unscattered_; }
  /// Of the last record() that has run.
  BeamTotals totals() const;

 private:
  const Domain& domain_;
  int channels_;
  float skin_;
  std::vector<std::uint32_t>
      first_of_round_;  // of sides_; a round for each start that a facet has at most, and the end
  FacetReceivers receivers_;
  gpu::Pass march_, source_, share_, spread_;
  gpu::Buffer deposits_, carries_, counters_, starts_, starts_of_, sides_, leaving_, gamma_s_, query_gamma_, entered_,
      near_, near_unscattered_, shares_, through_;
  gpu::Image power_, seen_, unscattered_;
  glm::dvec3 unit_{0};
};

/// Power of one unit, W: no beam that enters a facet of `domain` has more than BEAM_MOST_UNITS of them.
glm::dvec3 beam_unit(const LightSamples& lights, const GridFrame& frame);

}  // namespace alabaster

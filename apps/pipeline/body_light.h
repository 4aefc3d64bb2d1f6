// All that drives one object's fluence: the lights by the source of its transport, and light from other surfaces, which
// is diffuse and enters as the report's boundary source.
#pragma once

#include <functional>
#include <memory>

#include "diffusion/diffusion.h"
#include "lighting/beam_source.h"
#include "lighting/facet_source.h"
#include "planner/plan.h"
#include "shading/single.h"

namespace alabaster {

class BodyLight {
 public:
  /// `domain` and `diffusion` outlive this.
  BodyLight(gpu::Context& context, Transport transport, const Mesh& mesh, const Domain& domain,
            const Diffusion& diffusion, double eta);

  /// The lights, where no surface sends light to another. The shadow maps of `lighting` have been recorded.
  void record_lights(gpu::Commands& commands, const Lighting& lighting);

  // With light between surfaces, in three steps: what Exchange starts from; the lights, and what Exchange::around()
  // knows, where the transport brings them in itself (apart()); and after every Exchange::record_gather() the sum of
  // both.
  void record_lamps(gpu::Commands& commands, const Lighting& lighting) const;
  // `again`: the lights and the environment are as they were, and surfaces were known to send nothing.
  void record_lights_apart(gpu::Commands& commands, const Lighting& lighting, const Surroundings& around,
                           bool again = false);
  void record_surfaces(gpu::Commands& commands);
  /// True: facets().flux() is to hold what surfaces send and nothing else.
  bool apart() const { return directional_ || beam_; }
  const FacetSource& facets() const { return facets_; }
  /// From now on the report's Gamma_s is without what leaves by `single`, which outlives this. The other transports'
  /// sources stay: what leaves at once is in their query.
  void take_out(const SingleScattering& single) { single_ = apart() ? nullptr : &single; }

  /// Of what has been recorded and has run.
  FacetLight light() const;
  /// W, what enters by the transport's own source; 0 where that is facets(). `total` adds up vec3 of entries, W.
  glm::dvec3 own_power(const std::function<glm::dvec3(const gpu::Buffer&)>& total) const;
  BeamSource* beam() const { return beam_.get(); }

 private:
  struct Own {  // of the transport
    const gpu::Buffer &gamma_s, &query_gamma, &entered;
  };
  Own own() const;
  void record_own(gpu::Commands& commands, const Lighting& lighting, const Surroundings& around, bool more);

  const Diffusion& diffusion_;
  double eta_;
  FacetSource facets_;
  std::unique_ptr<DirectionalSource> directional_;  // of these the transport's, if any
  std::unique_ptr<BeamSource> beam_;
  const SingleScattering* single_ = nullptr;
  gpu::Pass add_;
  gpu::Buffer gamma_s_, query_gamma_, entered_;  // sums
  bool summed_ = false;
};

}  // namespace alabaster

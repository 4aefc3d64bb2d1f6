// Light between surfaces, in passes: each improves every fluence a little and then the light that surfaces send each
// other.
#pragma once

#include <vector>

#include "lighting/exchange.h"
#include "pipeline/body_light.h"

namespace alabaster {

/// A translucent object that is lit. The references outlive the passes.
struct LitBody {
  int object = 0;  // index in Scene::objects
  double eta = 1;
  const Domain& domain;
  Diffusion& diffusion;
  BodyLight& light;
};

struct ExchangeReport {
  int passes = 0;
  int directions = 0;    // of each facet
  double under_way = 0;  // light that the passes did not follow to its end, of what enters from the lights
  Exchange::Counts counts;
};

class Interreflections {
 public:
  /// Finds what every facet sees. The bodies' BodyLight::record_lamps() has run.
  Interreflections(gpu::Context& context, const Scene& scene, const Lighting& lighting, const Plan& plan,
                   std::vector<LitBody> bodies);

  /// What the lights send, and opaque surfaces back. Needed before all else.
  void start();
  /// Passes until what surfaces send each other no longer changes. The bodies' light is all light then.
  void approach();
  /// After the last solve: what its fluence sends back, which is what the energy balance needs.
  void settle();

  /// W that enter a body through its facets' boundary source (FacetSource::gamma_s).
  glm::dvec3 by_facets(std::size_t body) const;
  /// W, of all that enters a body what translucent surfaces sent: as the last solve had it, and after settle() as its
  /// fluence sends it.
  glm::dvec3 reentered(std::size_t body) const { return entered_[body] - at_start_[body]; }
  const ExchangeReport& report() const { return report_; }

 private:
  void light_apart(bool again);
  void learn();
  void gather();
  void send();
  std::vector<glm::dvec3> entering() const;
  double adopt(std::vector<glm::dvec3> entered);

  gpu::Context& context_;
  const Lighting& lighting_;
  const Plan& plan_;
  std::vector<LitBody> bodies_;
  Exchange exchange_;
  std::vector<glm::dvec3> at_start_, entered_;  // W, of each body
  glm::dvec3 lights_{0};                        // W, all that enters at first
  ExchangeReport report_;
};

}  // namespace alabaster

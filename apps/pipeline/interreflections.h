// Light between surfaces, in passes: each improves every fluence a little and then the light that surfaces send each
// other.
#pragma once

#include <vector>

#include "diffusion/diffusion.h"
#include "lighting/exchange.h"
#include "planner/plan.h"

namespace alabaster {

/// A translucent object that is lit. The references outlive the passes.
struct LitBody {
  int object = 0;  // index in Scene::objects
  double eta = 1;
  const Domain& domain;
  Diffusion& diffusion;
  const FacetSource& source;
  FacetLight light() const { return {source.gamma_s(), 2}; }
};

struct ExchangeReport {
  int passes = 0;
  int directions = 0;    // of each facet
  double under_way = 0;  // light that the passes did not follow to its end, of what enters from the lights
  Exchange::Counts counts;
};

class Interreflections {
 public:
  /// Finds what every facet sees. The bodies' FacetSource::record_direct() has run, without the environment.
  Interreflections(gpu::Context& context, const Scene& scene, const Lighting& lighting, const Plan& plan,
                   std::vector<LitBody> bodies);

  /// Passes until what surfaces send each other no longer changes. Leaves Gamma_s of all light in the bodies' sources.
  void approach();
  /// After the last solve: what its fluence sends back, which is what the energy balance needs.
  void settle();

  /// W that enter a body through its surface: from lamps, environment and opaque surfaces; and, after settle(), from
  /// translucent ones.
  glm::dvec3 from_lights(std::size_t body) const { return from_lights_[body]; }
  glm::dvec3 reentered(std::size_t body) const { return entered_[body] - from_lights_[body]; }
  const ExchangeReport& report() const { return report_; }

 private:
  void gather();
  void send();
  std::vector<glm::dvec3> entering() const;
  double adopt(std::vector<glm::dvec3> entered);

  gpu::Context& context_;
  const Plan& plan_;
  std::vector<LitBody> bodies_;
  Exchange exchange_;
  std::vector<glm::dvec3> from_lights_, entered_;  // W, of each body
  ExchangeReport report_;
};

}  // namespace alabaster

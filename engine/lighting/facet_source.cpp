#include "lighting/facet_source.h"

#include "shared/lighting.h"

namespace alabaster {

FacetSource::FacetSource(gpu::Context& context, const Domain& domain)
    : domain_(domain),
      count_(domain.summary.cut_cells + 1),
      receivers_pass_(context, "lighting/facet_receivers.comp"),
      source_pass_(context, "lighting/facet_source.comp"),
      receivers_(context, 2 * count_ * sizeof(Receiver), "facet receivers"),
      direct_(context, 2 * count_ * sizeof(glm::vec3), "facet flux of the lights"),
      flux_(context, 2 * count_ * sizeof(glm::vec3), "facet flux"),
      gamma_s_(context, 2 * count_ * sizeof(glm::vec3), "facet Gamma_s") {}

void FacetSource::record(gpu::Commands& commands, const Lighting& lighting, const gpu::Buffer& media,
                         double eta) const {
  record_direct(commands, lighting, eta);
  record_source(commands, media);
}

void FacetSource::record_direct(gpu::Commands& commands, const Lighting& lighting, double eta, bool environment) const {
  const FacetPush push{domain_.frame.origin, domain_.frame.h, count_};
  commands.dispatch(receivers_pass_, {2 * count_, 1, 1}, {{"cut_cells", domain_.cut_cells}, {"receivers", receivers_}},
                    push);
  lighting.record_gather(commands, receivers_, 2 * count_, eta, direct_, environment);
  commands.copy(direct_, flux_, direct_.bytes());
}

void FacetSource::record_source(gpu::Commands& commands, const gpu::Buffer& media) const {
  const FacetPush push{domain_.frame.origin, domain_.frame.h, count_};
  commands.dispatch(source_pass_, {2 * count_, 1, 1}, {{"flux", flux_}, {"media", media}, {"gamma_s", gamma_s_}}, push);
}

}  // namespace alabaster

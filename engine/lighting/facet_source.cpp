#include "lighting/facet_source.h"

#include "shared/lighting.h"

namespace alabaster {

FacetSource::FacetSource(gpu::Context& context, const Domain& domain)
    : domain_(domain),
      receivers_(context, domain),
      source_pass_(context, "lighting/facet_source.comp"),
      direct_(context, count() * sizeof(glm::vec3), "facet flux of the lights"),
      flux_(context, count() * sizeof(glm::vec3), "facet flux"),
      gamma_s_(context, count() * sizeof(glm::vec3), "facet Gamma_s") {}

void FacetSource::record(gpu::Commands& commands, const Lighting& lighting, const gpu::Buffer& media,
                         double eta) const {
  record_direct(commands, lighting, eta);
  record_source(commands, media);
}

void FacetSource::record_direct(gpu::Commands& commands, const Lighting& lighting, double eta, bool environment) const {
  receivers_.record(commands);
  lighting.record_gather(commands, receivers_.buffer(), count(), eta, direct_, environment);
  commands.copy(direct_, flux_, direct_.bytes());
}

void FacetSource::record_source(gpu::Commands& commands, const gpu::Buffer& media) const {
  const FacetPush push{domain_.frame.origin, domain_.frame.h, count() / 2};
  commands.dispatch(source_pass_, {count(), 1, 1}, {{"flux", flux_}, {"media", media}, {"gamma_s", gamma_s_}}, push);
}

}  // namespace alabaster

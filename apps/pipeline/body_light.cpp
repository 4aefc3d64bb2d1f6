#include "pipeline/body_light.h"

#include "shared/optics.h"

namespace alabaster {

BodyLight::BodyLight(gpu::Context& context, Transport transport, const Mesh& mesh, const Domain& domain,
                     const Diffusion& diffusion, double eta)
    : diffusion_(diffusion), eta_(eta), facets_(context, domain), add_(context, "lighting/add_source.comp") {
  if (transport == Transport::directional) directional_ = std::make_unique<DirectionalSource>(context, domain);
  if (transport == Transport::beam || transport == Transport::gather)
    beam_ = std::make_unique<BeamSource>(
        context, domain, mesh_starts(mesh, domain.frame, gpu::download<GpuCutCell>(context, domain.cut_cells)),
        diffusion.channels());
  if (!apart()) return;
  const std::size_t bytes = facets_.count() * sizeof(glm::vec3);
  gamma_s_ = gpu::Buffer(context, bytes, "Gamma of all light");
  query_gamma_ = gpu::Buffer(context, bytes, "query Gamma of all light");
  entered_ = gpu::Buffer(context, bytes, "all that enters");
}

void BodyLight::record_own(gpu::Commands& commands, const Lighting& lighting, const Surroundings& around, bool more) {
  const Diffusion& d = diffusion_;
  const gpu::Buffer& media = d.facet_medium();
  if (directional_) directional_->record(commands, lighting, media, eta_, around);
  if (beam_)
    beam_->record(commands, lighting, {d.kappa(), d.absorption(), media, d.kappa_scale(), d.channels()}, eta_, around,
                  more);
}

void BodyLight::record_lights(gpu::Commands& commands, const Lighting& lighting) {
  summed_ = false;
  if (apart())
    record_own(commands, lighting, {}, false);
  else
    facets_.record(commands, lighting, diffusion_.facet_medium(), eta_);
  if (single_) single_->record_take(commands, facets_.gamma_s());
}

void BodyLight::record_lamps(gpu::Commands& commands, const Lighting& lighting) const {
  facets_.record_direct(commands, lighting, eta_, false);
}

void BodyLight::record_lights_apart(gpu::Commands& commands, const Lighting& lighting, const Surroundings& around,
                                    bool again) {
  if (apart()) record_own(commands, lighting, around, again);
}

void BodyLight::record_surfaces(gpu::Commands& commands) {
  facets_.record_source(commands, diffusion_.facet_medium());
  if (single_) single_->record_take(commands, facets_.gamma_s());
  summed_ = apart();
  if (!summed_) return;
  const Own lights = own();
  commands.dispatch(add_, {facets_.count(), 1, 1},
                    {{"own_gamma", lights.gamma_s},
                     {"own_query", lights.query_gamma},
                     {"own_entered", lights.entered},
                     {"surfaces_gamma", facets_.gamma_s()},
                     {"surfaces_flux", facets_.flux()},
                     {"gamma_s", gamma_s_},
                     {"query_gamma", query_gamma_},
                     {"entered", entered_}},
                    facets_.count());
}

BodyLight::Own BodyLight::own() const {
  if (beam_) return {beam_->gamma_s(), beam_->query_gamma(), beam_->entered()};
  if (directional_) return {directional_->gamma_s(), directional_->query_gamma(), directional_->entered()};
  if (single_) return {facets_.gamma_s(), single_->query_gamma(), single_->entered()};
  return {facets_.gamma_s(), facets_.gamma_s(), facets_.gamma_s()};
}

glm::dvec3 BodyLight::own_power(const std::function<glm::dvec3(const gpu::Buffer&)>& total) const {
  if (beam_) return beam_->totals().entered;
  if (!directional_) return glm::dvec3(0);
  const SurfaceOptics optics(eta_);
  const glm::dvec3 gamma = total(directional_->gamma_s()), query = total(directional_->query_gamma());
  glm::dvec3 power;
  for (int c = 0; c < 3; ++c) power[c] = entering_flux(gamma[c], query[c], optics.A, optics.f_dt);
  return power;
}

FacetLight BodyLight::light() const {
  const Own all = summed_ ? Own{gamma_s_, query_gamma_, entered_} : own();
  FacetLight light(all.gamma_s, 2);
  light.query = &all.query_gamma;
  light.entered = &all.entered;
  if (!beam_) return light;
  light.volume = &beam_->power();
  light.volume_power = beam_->totals().in_cells;
  light.through = &beam_->through();
  return light;
}

}  // namespace alabaster

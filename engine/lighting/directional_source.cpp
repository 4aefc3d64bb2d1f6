#include "lighting/directional_source.h"

#include "shared/optics.h"

namespace alabaster {

SurfaceOptics::SurfaceOptics(double index)
    : eta(index),
      f_dt_outer(1 - diffuse_reflectance(index)),
      A(boundary_constant(internal_diffuse_reflectance(index))),
      f_dt(1 - internal_diffuse_reflectance(index)) {}

EntryPush SurfaceOptics::push(std::uint32_t receivers, SkyLinks sky) const {
  return {receivers,
          static_cast<float>(eta),
          static_cast<float>(f_dt_outer),
          static_cast<float>(A),
          static_cast<float>(f_dt),
          sky};
}

gpu::Bindings arrival_bindings(const Lighting& lighting, const FacetReceivers& receivers, const Surroundings& around) {
  const auto given = [&](const gpu::Buffer* buffer) -> const gpu::Buffer& {
    return buffer ? *buffer : receivers.buffer();
  };
  gpu::Bindings all = lighting.bindings();
  all.push_back({"receivers", receivers.buffer()});
  all.push_back({"links", given(around.links)});
  all.push_back({"side_of", given(around.side_of)});
  all.push_back({"known_transmitted", given(around.transmitted)});
  all.push_back({"known_mirrored", given(around.mirrored)});
  return all;
}

DirectionalSource::DirectionalSource(gpu::Context& context, const Domain& domain)
    : receivers_(context, domain),
      pass_(context, "lighting/directional_source.comp"),
      gamma_s_(context, receivers_.count() * sizeof(glm::vec3), "directional Gamma_f"),
      query_gamma_(context, receivers_.count() * sizeof(glm::vec3), "directional query Gamma"),
      entered_(context, receivers_.count() * sizeof(glm::vec3), "entered flux") {}

void DirectionalSource::record(gpu::Commands& commands, const Lighting& lighting, const gpu::Buffer& media, double eta,
                               const Surroundings& around) const {
  receivers_.record(commands);
  const auto timer = commands.time("entry");
  gpu::Bindings bindings = arrival_bindings(lighting, receivers_, around);
  bindings.push_back({"media", media});
  bindings.push_back({"gamma_s", gamma_s_});
  bindings.push_back({"query_gamma", query_gamma_});
  bindings.push_back({"entered", entered_});
  commands.dispatch(pass_, {receivers_.count(), 1, 1}, bindings,
                    SurfaceOptics(eta).push(receivers_.count(), around.shape));
}

}  // namespace alabaster

#include "shading/gather_exit.h"

#include "shading/straight.h"

namespace alabaster {
namespace {

gpu::Image cell_image(gpu::Context& context, const Domain& domain, const char* name) {
  return gpu::image3d(context, domain.frame.cells, VK_FORMAT_R32G32B32A32_SFLOAT, name);
}

/// An odd stride: both sides of cells come in turn.
GatherLevelPush push_of(std::uint32_t sides) {
  const std::uint32_t stride = (sides / GATHER_ASKED) | 1;
  return {(sides + stride - 1) / stride, stride};
}

}  // namespace

GatherExit::GatherExit(gpu::Context& context, const Domain& domain, const Diffusion& diffusion, const BeamSource& beam,
                       const DeviceRayTree& rays, double eta)
    : context_(context),
      domain_(domain),
      diffusion_(diffusion),
      beam_(beam),
      rays_(rays),
      push_(push_of(2 * (domain.summary.cut_cells + 1))),
      fluence_pass_(context, "shading/beam_fluence.comp"),
      spread_pass_(context, "shading/spread_facets.comp"),
      level_pass_(context, "shading/gather_level.comp"),
      linear_(context, gpu::Filter::linear),
      grid_(gpu::make_buffer(context, std::vector<GatherGrid>{ray_grid(domain, diffusion, eta)}, "gather grid")),
      fluxes_(context, push_.count * sizeof(GatherFlux), "gather fluxes", gpu::Memory::host),
      level_buffer_(context, sizeof(glm::vec3), "gather level", gpu::Memory::host),
      fluence_(cell_image(context, domain, "beam fluence")),
      near_{cell_image(context, domain, "near light, up"), cell_image(context, domain, "near light, down")} {}

gpu::Bindings GatherExit::ray_bindings() const {
  gpu::Bindings bindings = way_bindings(grid_, domain_, diffusion_);
  for (const gpu::Bindings& more :
       {rays_.bindings(), gpu::Bindings{{"beam_fluence", fluence_, linear_},
                                        {"near_up", near_[0], linear_},
                                        {"near_down", near_[1], linear_},
                                        {"field_up", diffusion_.surface(0), linear_},
                                        {"field_down", diffusion_.surface(1), linear_},
                                        {"drive_up", diffusion_.surface_gamma(0), linear_},
                                        {"drive_down", diffusion_.surface_gamma(1), linear_}}})
    bindings.insert(bindings.end(), more.begin(), more.end());
  return bindings;
}

gpu::Bindings GatherExit::picture_bindings() const {
  gpu::Bindings bindings = ray_bindings();
  bindings.push_back({"level", level_buffer_});
  return bindings;
}

void GatherExit::update() {
  gpu::Commands commands(context_);
  {
    const auto timer = commands.time("gather levels");
    commands.dispatch(fluence_pass_, glm::uvec3(domain_.frame.cells),
                      {{"grid", grid_},
                       {"volume", domain_.volume},
                       {"power", beam_.power()},
                       {"cut_cells", domain_.cut_cells},
                       {"kappa", diffusion_.kappa()},
                       {"absorption", diffusion_.absorption()},
                       {"fluence", fluence_}});
    commands.dispatch(spread_pass_, glm::uvec3(domain_.frame.cells),
                      {{"values", beam_.near()},
                       {"cut_index", domain_.cut_index},
                       {"cut_cells", domain_.cut_cells},
                       {"up", near_[0]},
                       {"down", near_[1]}},
                      GatherPicturePush{domain_.frame.cells, static_cast<int>(domain_.summary.cut_cells) + 1});
    gpu::Bindings bindings = ray_bindings();
    bindings.push_back({"fluxes", fluxes_});
    commands.dispatch(level_pass_, {push_.count, 1, 1}, bindings, push_);
  }
  commands.submit();
  const auto* fluxes = static_cast<const GatherFlux*>(fluxes_.mapped());
  glm::dvec3 wanted(0), gathered(0);
  for (std::uint32_t k = 0; k < push_.count; ++k) {
    wanted += glm::dvec3(fluxes[k].wanted);
    gathered += glm::dvec3(fluxes[k].gathered);
  }
  for (int c = 0; c < 3; ++c) level_[c] = gathered[c] > 0 ? wanted[c] / gathered[c] : 1;
  *static_cast<glm::vec3*>(level_buffer_.mapped()) = glm::vec3(level_);
}

}  // namespace alabaster

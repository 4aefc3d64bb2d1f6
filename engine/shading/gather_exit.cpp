#include "shading/gather_exit.h"

#include "shading/straight.h"

namespace alabaster {
namespace {

gpu::Image cell_image(gpu::Context& context, const Domain& domain, const char* name) {
  return gpu::image3d(context, domain.frame.cells, VK_FORMAT_R32G32B32A32_SFLOAT, name);
}

}  // namespace

GatherExit::GatherExit(gpu::Context& context, const Domain& domain, const Diffusion& diffusion, const BeamSource& beam,
                       const DeviceRayTree& rays, double eta)
    : domain_(domain),
      diffusion_(diffusion),
      beam_(beam),
      rays_(rays),
      push_{domain.frame.cells, static_cast<int>(domain.summary.cut_cells) + 1},
      density_pass_(context, "shading/beam_density.comp"),
      spread_pass_(context, "shading/spread_facets.comp"),
      level_pass_(context, "shading/gather_level.comp"),
      ratio_pass_(context, "shading/gather_ratio.comp"),
      linear_(context, gpu::Filter::linear),
      grid_(gpu::make_buffer(context, std::vector<GatherGrid>{ray_grid(domain, diffusion, eta)}, "gather grid")),
      fluxes_(context, 2 * push_.count * sizeof(GatherFlux), "gather fluxes"),
      levels_(context, 2 * push_.count * sizeof(glm::vec4), "gather levels"),
      counts_(context, 2 * sizeof(std::uint32_t), "gather counts", gpu::Memory::host),
      density_(cell_image(context, domain, "beam density")),
      near_{cell_image(context, domain, "near light, up"), cell_image(context, domain, "near light, down")},
      level_{cell_image(context, domain, "gather level, up"), cell_image(context, domain, "gather level, down")} {}

gpu::Bindings GatherExit::ray_bindings() const {
  gpu::Bindings bindings = way_bindings(grid_, domain_, diffusion_);
  for (const gpu::Bindings& more :
       {rays_.bindings(), gpu::Bindings{{"beam_density", density_, linear_},
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
  bindings.push_back({"level_up", level_[0], linear_});
  bindings.push_back({"level_down", level_[1], linear_});
  return bindings;
}

void GatherExit::record_spread(gpu::Commands& commands, const gpu::Buffer& values, const gpu::Image* images) const {
  commands.dispatch(spread_pass_, glm::uvec3(domain_.frame.cells),
                    {{"values", values},
                     {"cut_index", domain_.cut_index},
                     {"cut_cells", domain_.cut_cells},
                     {"up", images[0]},
                     {"down", images[1]}},
                    push_);
}

void GatherExit::record(gpu::Commands& commands) const {
  const auto timer = commands.time("gather levels");
  commands.dispatch(density_pass_, glm::uvec3(domain_.frame.cells),
                    {{"grid", grid_}, {"volume", domain_.volume}, {"power", beam_.power()}, {"density", density_}});
  record_spread(commands, beam_.near(), near_);
  gpu::Bindings bindings = ray_bindings();
  bindings.push_back({"fluxes", fluxes_});
  commands.fill(counts_);
  commands.dispatch(level_pass_, {push_.count, 1, 1}, bindings, push_);
  commands.dispatch(ratio_pass_, {2 * push_.count, 1, 1},
                    {{"fluxes", fluxes_},
                     {"cut_index", domain_.cut_index},
                     {"cut_cells", domain_.cut_cells},
                     {"levels", levels_},
                     {"counts", counts_}},
                    push_);
  record_spread(commands, levels_, level_);
}

GatherExit::Counts GatherExit::counts() const {
  const auto* words = static_cast<const std::uint32_t*>(counts_.mapped());
  return {words[GATHER_SIDES], words[GATHER_BOUNDED]};
}

}  // namespace alabaster

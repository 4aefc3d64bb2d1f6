#include "shading/gather_exit.h"

#include <algorithm>
#include <cmath>

#include "shading/straight.h"

namespace alabaster {
namespace {

gpu::Image cell_image(gpu::Context& context, const Domain& domain, const char* name,
                      VkFormat format = VK_FORMAT_R32G32B32A32_SFLOAT) {
  return gpu::image3d(context, domain.frame.cells, format, name);
}

/// An odd stride: both sides of cells come in turn.
GatherLevelPush push_of(std::uint32_t sides) {
  const std::uint32_t stride = (sides / GATHER_ASKED) | 1;
  return {(sides + stride - 1) / stride, stride};
}

/// Where the sides k * stride are.
std::vector<GatherPlace> places_of(const std::vector<GpuCutCell>& cut_cells, GatherLevelPush push) {
  std::vector<GatherPlace> places(push.count);
  for (std::uint32_t k = 0; k < push.count; ++k) {
    const std::uint32_t entry = k * push.stride;
    const GpuCutCell& cut = cut_cells[entry / 2];
    const glm::vec3 vector = cut.side[entry % 2].area_vector;
    const float size = glm::length(vector);
    places[k] = {glm::vec3(cut.cell) + cut.side[entry % 2].centre, size > 0 ? vector / size : glm::vec3(0, 0, 1), {}};
  }
  return places;
}

std::vector<GatherGrid> gather_grid(GatherGrid grid, float skin, float level_edge) {
  grid.skin = skin;
  grid.level_edge = level_edge;
  return {grid};
}

/// Cells in GATHER_LEVEL_REACH mean free paths of the medium, on the mean over its cells and channels.
float level_edge(gpu::Context& context, const Domain& domain, const Diffusion& diffusion) {
  const glm::ivec3 n = domain.frame.cells;
  const std::vector<float> volume = gpu::download<float>(context, domain.volume),
                           kappa = gpu::download<float>(context, diffusion.kappa());
  double paths = 0, cells = 0;  // 3 kappa, summed
  for (std::size_t i = 0; i < kappa.size(); ++i) {
    const double inside = volume[i % volume.size()];
    cells += inside;
    paths += inside * 3 * kappa[i] * diffusion.kappa_scale()[static_cast<int>(i / volume.size())];
  }
  const double reach = cells > 0 ? GATHER_LEVEL_REACH * paths / cells / domain.frame.h : 0;
  return static_cast<float>(std::clamp<double>(reach, GATHER_LEAST_LEVEL_EDGE, std::max({n.x, n.y, n.z})));
}

/// Of successive over-relaxation: what is left of an error falls as relaxation - 1 a sweep.
struct Sweeps {
  double relaxation;
  int count;
};

/// `longest`: the longest mean free path, h. Where it is so long that `most` sweeps do not do, light is spread as far
/// as they carry it.
Sweeps sweeps_for(double longest) {
  constexpr double left = 0.02;
  constexpr int most = 40, more = 2;  // before the errors fall at that rate
  const double joined = 6 * GATHER_SPREAD * longest * longest, jacobi = joined / (1 + joined);
  const double rate =
      std::clamp(2 / (1 + std::sqrt(1 - jacobi * jacobi)) - 1, 1e-3, std::pow(left, 1.0 / (most - more)));
  return {1 + rate, more + static_cast<int>(std::ceil(std::log(left) / std::log(rate) - 1e-9))};
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
      places_(places_of(gpu::download<GpuCutCell>(context, domain.cut_cells), push_)),
      edge_(level_edge(context, domain, diffusion)),
      closures_(eta),
      fluence_pass_(context, "shading/beam_fluence.comp"),
      beam_spread_pass_(context, "shading/beam_spread.comp"),
      beam_shift_pass_(context, "shading/beam_shift.comp"),
      spread_pass_(context, "shading/spread_facets.comp"),
      unscattered_pass_(context, "shading/unscattered.comp"),
      level_pass_(context, "shading/gather_level.comp"),
      linear_(context, gpu::Filter::linear),
      grid_(
          gpu::make_buffer(context, gather_grid(ray_grid(domain, diffusion, eta), beam.skin(), edge_), "gather grid")),
      fluxes_(context, push_.count * sizeof(GatherFlux), "gather fluxes", gpu::Memory::host),
      fluence_(cell_image(context, domain, "beam fluence")),
      shift_(cell_image(context, domain, "shift of beams' fluence")),
      spread_(cell_image(context, domain, "spread fluence of beams")),
      near_{cell_image(context, domain, "near light, up"), cell_image(context, domain, "near light, down")},
      unscattered_(cell_image(context, domain, "share of lamps' beams", VK_FORMAT_R8G8B8A8_UNORM)) {}

gpu::Bindings GatherExit::ray_bindings() const {
  gpu::Bindings bindings = way_bindings(grid_, domain_, diffusion_);
  for (const gpu::Bindings& more :
       {rays_.bindings(), gpu::Bindings{{"beam_fluence", fluence_, linear_},
                                        {"beam_shift", shift_, linear_},
                                        {"near_up", near_[0], linear_},
                                        {"near_down", near_[1], linear_},
                                        {"unscattered", unscattered_, linear_},
                                        {"field_up", diffusion_.surface(0), linear_},
                                        {"field_down", diffusion_.surface(1), linear_},
                                        {"drive_up", diffusion_.surface_gamma(0), linear_},
                                        {"drive_down", diffusion_.surface_gamma(1), linear_}}})
    bindings.insert(bindings.end(), more.begin(), more.end());
  return bindings;
}

gpu::Bindings GatherExit::picture_bindings() const {
  gpu::Bindings bindings = ray_bindings();
  bindings.push_back({"levels", level_image_, linear_});
  return bindings;
}

void GatherExit::spread_beams(gpu::Commands& commands) {
  const glm::dvec3 kappa = diffusion_.kappa_scale();
  const Sweeps sweeps = sweeps_for(3 * std::max({kappa.x, kappa.y, kappa.z}) / domain_.frame.h);
  const glm::ivec3 n = domain_.frame.cells;
  for (int half = 0; half < 2 * sweeps.count; ++half)
    commands.dispatch(
        beam_spread_pass_, glm::uvec3((n.x + 1) / 2, n.y, n.z),
        {{"grid", grid_},
         {"volume", domain_.volume},
         {"kappa", diffusion_.kappa()},
         {"cut_index", domain_.cut_index},
         {"cut_cells", domain_.cut_cells},
         {"aperture_x", domain_.aperture[0]},
         {"aperture_y", domain_.aperture[1]},
         {"aperture_z", domain_.aperture[2]},
         {"beams", shift_},
         {"spread", spread_}},
        GatherSpreadPush{static_cast<float>(closures_.leak()), static_cast<float>(sweeps.relaxation), half % 2});
  commands.dispatch(beam_shift_pass_, glm::uvec3(n),
                    {{"volume", domain_.volume}, {"spread", spread_}, {"shift", shift_}},
                    GatherShiftPush{n, static_cast<float>(closures_.kept())});
}

void GatherExit::update() {
  gpu::Commands commands(context_);
  {
    const auto timer = commands.time("gather levels");
    commands.dispatch(fluence_pass_, glm::uvec3(domain_.frame.cells),
                      {{"grid", grid_},
                       {"volume", domain_.volume},
                       {"power", beam_.seen()},
                       {"cut_cells", domain_.cut_cells},
                       {"kappa", diffusion_.kappa()},
                       {"absorption", diffusion_.absorption()},
                       {"cut_index", domain_.cut_index},
                       {"near_light", beam_.near()},
                       {"fluence", fluence_},
                       {"shift", shift_},
                       {"spread", spread_}});
    spread_beams(commands);
    commands.dispatch(spread_pass_, glm::uvec3(domain_.frame.cells),
                      {{"values", beam_.near()},
                       {"cut_index", domain_.cut_index},
                       {"cut_cells", domain_.cut_cells},
                       {"up", near_[0]},
                       {"down", near_[1]}},
                      GatherPicturePush{domain_.frame.cells, static_cast<int>(domain_.summary.cut_cells) + 1});
    commands.dispatch(unscattered_pass_, glm::uvec3(domain_.frame.cells),
                      {{"grid", grid_},
                       {"power", beam_.seen()},
                       {"power_share", beam_.unscattered()},
                       {"cut_index", domain_.cut_index},
                       {"cut_cells", domain_.cut_cells},
                       {"near_light", beam_.near()},
                       {"near_unscattered", beam_.near_unscattered()},
                       {"fluence", fluence_},
                       {"near_up", near_[0]},
                       {"near_down", near_[1]},
                       {"share", unscattered_}});
    gpu::Bindings bindings = ray_bindings();
    bindings.push_back({"fluxes", fluxes_});
    commands.dispatch(level_pass_, {push_.count, 1, 1}, bindings, push_);
  }
  commands.submit();
  const auto* fluxes = static_cast<const GatherFlux*>(fluxes_.mapped());
  for (std::uint32_t k = 0; k < push_.count; ++k) places_[k].flux = fluxes[k];
  levels_.emplace(domain_.frame.cells, edge_, places_);
  const glm::ivec3 nodes = levels_->nodes();
  level_image_ =
      gpu::image3d(context_, {nodes.x, nodes.y, 6 * nodes.z}, VK_FORMAT_R32G32B32A32_SFLOAT, "gather levels");
  gpu::upload(context_, level_image_, levels_->texels());
}

}  // namespace alabaster

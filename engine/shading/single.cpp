#include "shading/single.h"

#include <algorithm>
#include <cmath>

#include "lighting/directional_source.h"
#include "shading/straight.h"
#include "shared/gather.h"

namespace alabaster {

static_assert(sizeof(SingleGrid) == 96 && sizeof(SingleFluxPush) == 36);

namespace {

std::vector<float> share_table(double eta, double g) {
  std::vector<float> table;
  for (int i = 0; i < SINGLE_TABLE; ++i) {
    const double root = double(i) / (SINGLE_TABLE - 1);
    table.push_back(static_cast<float>(single_scattering_share(root * root, eta, g)));
  }
  return table;
}

SingleFluxPush push_of(std::uint32_t sides, double eta, double g) {
  const SurfaceOptics optics(eta);
  return {sides,
          static_cast<float>(eta),
          static_cast<float>(optics.f_dt_outer),
          static_cast<float>(optics.A),
          static_cast<float>(optics.f_dt),
          static_cast<float>(g),
          {0, 0}};
}

SingleGrid grid_of(const Domain& domain, const Diffusion& diffusion, const SingleScattering::Subject& subject) {
  const SurfaceOptics optics(subject.eta);
  const Medium& medium = subject.medium;
  SingleGrid grid;
  grid.cells = domain.frame.cells;
  grid.channels = diffusion.channels();
  grid.origin = domain.frame.origin;
  grid.h = domain.frame.h;
  grid.kappa_scale = diffusion.kappa_scale();
  grid.eta = static_cast<float>(subject.eta);
  grid.A = static_cast<float>(optics.A);
  grid.f_dt = static_cast<float>(optics.f_dt);
  grid.f_dt_outer = static_cast<float>(optics.f_dt_outer);
  grid.g = static_cast<float>(medium.g);
  grid.object = static_cast<std::uint32_t>(subject.object);
  grid.varies = medium.heterogeneous();
  grid.sigma_s = medium.homogeneous.sigma_s;
  grid.sigma_a = medium.homogeneous.sigma_a;
  return grid;
}

gpu::Image cell_image(gpu::Context& context, const Domain& domain, const char* name) {
  return gpu::image3d(context, domain.frame.cells, VK_FORMAT_R32G32B32A32_SFLOAT, name);
}

std::uint32_t light_count(const Lighting& lighting) {
  return static_cast<std::uint32_t>(lighting.samples().area.size() + lighting.samples().directions.size());
}

}  // namespace

// Midpoint rule over the outside cosine c, from which mu' dmu' = c dc / eta^2, and over the azimuth.
double single_scattering_share(double mu, double eta, double g) {
  constexpr int cosines = 128, azimuths = 32;
  const double sine = std::sqrt(std::max(0.0, 1 - mu * mu));
  double sum = 0;
  for (int i = 0; i < cosines; ++i) {
    const double c = (i + 0.5) / cosines, out = refracted_cosine(c, eta);
    if (out <= 0) continue;
    const double sines = sine * std::sqrt(std::max(0.0, 1 - out * out));
    double phase = 0;
    for (int k = 0; k < azimuths; ++k)
      phase += henyey_greenstein(g, sines * std::cos(M_PI * (k + 0.5) / azimuths) - mu * out) / azimuths;
    sum += 2 * M_PI * phase * fresnel_transmittance(c, eta) * c / (eta * eta) / (mu + out) / cosines;
  }
  return sum;
}

SingleScattering::SingleScattering(gpu::Context& context, const Domain& domain, const Diffusion& diffusion,
                                   const Subject& subject)
    : context_(context),
      domain_(domain),
      diffusion_(diffusion),
      receivers_(context, domain),
      push_(push_of(receivers_.count(), subject.eta, subject.medium.g)),
      flux_pass_(context, "shading/single_flux.comp"),
      leaves_pass_(context, "shading/single_leaves.comp"),
      scale_pass_(context, "shading/single_scale.comp"),
      take_pass_(context, "shading/single_take.comp"),
      spread_pass_(context, "shading/spread_facets.comp"),
      linear_(context, gpu::Filter::linear),
      shares_(gpu::make_buffer(context, share_table(subject.eta, subject.medium.g), "single scattering shares")),
      grid_(gpu::make_buffer(context, std::vector<SingleGrid>{grid_of(domain, diffusion, subject)},
                             "single scattering grid")),
      flux_(context, push_.sides * sizeof(glm::vec4), "single scattering flux"),
      query_gamma_(context, push_.sides * sizeof(glm::vec3), "query Gamma with single scattering"),
      entered_(context, push_.sides * sizeof(glm::vec3), "what enters, with single scattering"),
      images_{cell_image(context, domain, "single scattering flux, up"),
              cell_image(context, domain, "single scattering flux, down")} {}

void SingleScattering::prepare(const Lighting& lighting, const SceneMeshes& meshes) {
  {
    gpu::Commands commands(context_);
    receivers_.record(commands);
    gpu::Bindings bindings = arrival_bindings(lighting, receivers_, {});
    bindings.push_back({"media", diffusion_.facet_medium()});
    bindings.push_back({"shares", shares_});
    bindings.push_back({"single_flux", flux_});
    {
      const auto timer = commands.time("single flux");
      commands.dispatch(flux_pass_, {push_.sides, 1, 1}, bindings, push_);
    }
    commands.submit();
  }
  scale_ = measure_scale(lighting, meshes);
  gpu::Commands commands(context_);
  commands.dispatch(scale_pass_, {push_.sides, 1, 1}, {{"single_flux", flux_}}, SingleScalePush{push_.sides, scale_});
  commands.dispatch(spread_pass_, glm::uvec3(domain_.frame.cells),
                    {{"values", flux_},
                     {"cut_index", domain_.cut_index},
                     {"cut_cells", domain_.cut_cells},
                     {"up", images_[0]},
                     {"down", images_[1]}},
                    GatherPicturePush{domain_.frame.cells, static_cast<int>(push_.sides / 2)});
  commands.submit();
}

glm::vec3 SingleScattering::measure_scale(const Lighting& lighting, const SceneMeshes& meshes) const {
  SingleLeavesPush push{};
  push.stride = (push_.sides / SINGLE_ASKED) | 1;  // odd: both sides of cells come in turn
  push.count = (push_.sides + push.stride - 1) / push.stride;
  const gpu::Buffer leaves(context_, push.count * sizeof(glm::vec4), "single scattering leaves");
  gpu::Bindings bindings = way_bindings(grid_, domain_, diffusion_);
  for (const gpu::Bindings& more : {lighting.bindings(), meshes.rays.bindings()})
    bindings.insert(bindings.end(), more.begin(), more.end());
  bindings.push_back({"receivers", receivers_.buffer()});
  bindings.push_back({"leaves", leaves});
  gpu::Commands commands(context_);
  {
    const auto timer = commands.time("single leaves");
    for (const std::uint32_t lights = light_count(lighting); push.first_light < lights;
         push.first_light = push.end_light) {
      push.end_light = std::min(lights, push.first_light + SINGLE_LIGHTS);
      commands.dispatch(leaves_pass_, {push.count, 1, 1}, bindings, push);
    }
  }
  commands.submit();
  const auto drawn = gpu::download<glm::vec4>(context_, leaves), planes = gpu::download<glm::vec4>(context_, flux_);
  const auto cut_cells = gpu::download<GpuCutCell>(context_, domain_.cut_cells);
  glm::dvec3 of_drawn(0), of_planes(0);
  for (std::uint32_t k = 0, i = 0; k < push.count; ++k, i += push.stride) {
    const double area = cut_cells[i / 2].side[i % 2].area;
    of_drawn += area * glm::dvec3(drawn[k]);
    of_planes += area * glm::dvec3(planes[i]);
  }
  glm::vec3 scale(1);
  for (int c = 0; c < 3; ++c)
    if (of_planes[c] > 0) scale[c] = static_cast<float>(of_drawn[c] / of_planes[c]);
  return scale;
}

void SingleScattering::record_take(gpu::Commands& commands, const gpu::Buffer& gamma_s) const {
  commands.dispatch(take_pass_, {push_.sides, 1, 1},
                    {{"single_flux", flux_},
                     {"media", diffusion_.facet_medium()},
                     {"gamma_s", gamma_s},
                     {"query_gamma", query_gamma_},
                     {"entered", entered_}},
                    push_);
}

gpu::Bindings SingleScattering::picture_bindings() const {
  gpu::Bindings bindings = way_bindings(grid_, domain_, diffusion_);
  for (const gpu::Binding& binding : gpu::Bindings{{"phi_up", diffusion_.surface(0), linear_},
                                                   {"phi_down", diffusion_.surface(1), linear_},
                                                   {"gamma_up", diffusion_.surface_gamma(0), linear_},
                                                   {"gamma_down", diffusion_.surface_gamma(1), linear_},
                                                   {"single_up", images_[0], linear_},
                                                   {"single_down", images_[1], linear_}})
    bindings.push_back(binding);
  return bindings;
}

}  // namespace alabaster

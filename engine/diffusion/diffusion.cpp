#include "diffusion/diffusion.h"

#include <algorithm>
#include <cmath>

#include "diffusion/near_surface.h"
#include "shared/optics.h"

namespace alabaster {
namespace {

constexpr double nearly_right = 0.1, nearly_there = 0.01, well_begun = 3e-3;  // relative residuals

struct EnergyPush {
  SurfacePush surface;
  int partials_per_channel;
};

struct ExitPush {
  SurfacePush surface;
  float exit_scale;
  std::uint32_t first;
};

std::vector<std::uint8_t> active_cells(gpu::Context& context, const Domain& domain) {
  const std::vector<float> volume = gpu::download<float>(context, domain.volume);
  std::vector<std::uint8_t> active(volume.size());
  std::transform(volume.begin(), volume.end(), active.begin(), [](float v) { return v > 0; });
  return active;
}

gpu::Image surface_image(gpu::Context& context, const Domain& domain, const std::string& name) {
  return gpu::image3d(context, domain.frame.cells, VK_FORMAT_R32G32B32A32_SFLOAT, name);
}

}  // namespace

gpu::Image cut_table(gpu::Context& context, std::size_t count, int layers, const std::string& name) {
  const int rows = static_cast<int>((count + DIFFUSION_TABLE_WIDTH - 1) / DIFFUSION_TABLE_WIDTH);
  return gpu::image3d(context, {DIFFUSION_TABLE_WIDTH, rows, layers}, VK_FORMAT_R32G32B32A32_SFLOAT, name);
}

FluencePasses::FluencePasses(gpu::Context& c)
    : points{c, "diffusion/points.comp"},
      conductances{c, "diffusion/conductances.comp"},
      assemble{c, "diffusion/operator.comp", {1}},
      scale{c, "diffusion/scale.comp"},
      facets{{c, "diffusion/facets.comp", {0}}, {c, "diffusion/facets.comp", {1}}},
      rim{c, "diffusion/rim.comp"},
      power{c, "diffusion/power.comp", {1}},
      source{{{c, "diffusion/source.comp", {0, 0}}, {c, "diffusion/source.comp", {0, 1}}},
             {{c, "diffusion/source.comp", {1, 0}}, {c, "diffusion/source.comp", {1, 1}}}},
      rescale{c, "diffusion/rescale.comp", {1}},
      absorbed{c, "diffusion/absorbed.comp", {1}},
      energy{c, "diffusion/energy.comp"},
      gradient{c, "diffusion/gradient.comp"},
      carry{c, "diffusion/carry.comp"},
      inner{{c, "diffusion/inner.comp", {1, 1}}, {c, "diffusion/inner.comp", {1, 3}}},
      surface{{c, "diffusion/surface.comp", {1}}, {c, "diffusion/surface.comp", {3}}},
      exit{{c, "diffusion/exit.comp", {0}}, {c, "diffusion/exit.comp", {1}}} {}

double EnergyBalance::imbalance() const {
  double worst = 0;
  for (int c = 0; c < 3; ++c)
    if (in[c] > 0) worst = std::max(worst, std::abs(in[c] - absorbed[c] - out[c]) / in[c]);
  return worst;
}

Diffusion::Diffusion(gpu::Context& context, const DiffusionPasses& solver_passes, const FluencePasses& passes,
                     const Domain& domain, MediumSamples medium, double eta, const SolverOptions& options)
    : context_(context),
      passes_(passes),
      domain_(domain),
      A_(boundary_constant(internal_diffuse_reflectance(eta))),
      f_dt_(1 - internal_diffuse_reflectance(eta)),
      cut_count_(static_cast<int>(domain.summary.cut_cells) + 1),
      kappa_(packed_image(context, domain.frame.cells, medium.channels, 1, "kappa")),
      absorption_(packed_image(context, domain.frame.cells, medium.channels, 1, "absorption")),
      surface_{surface_image(context, domain, "surface fluence, up"),
               surface_image(context, domain, "surface fluence, down")},
      surface_gamma_{surface_image(context, domain, "surface Gamma_s, up"),
                     surface_image(context, domain, "surface Gamma_s, down")},
      points_(cut_table(context, cut_count_, DIFFUSION_POINT_LAYERS, "points of the surface")),
      lines_(cut_table(context, cut_count_, 2 * medium.channels, "surface lines")),
      side_lights_(cut_table(context, cut_count_, 2, "surface lights")),
      gradients_(cut_table(context, cut_count_, medium.channels, "surface gradients")),
      conductances_(cut_table(context, cut_count_, medium.channels, "facet conductances")),
      face_fluxes_(cut_table(context, cut_count_, 2 * medium.channels, "face corrections")),
      rim_(find_rim(context, domain)),
      facets_(context, cut_count_ * sizeof(FacetMedium), "facet medium"),
      scales_(context, medium.channels * sizeof(FluenceScale), "fluence scales", gpu::Memory::host),
      energy_sums_(context, medium.channels * sizeof(EnergySums), "energy sums", gpu::Memory::host),
      cell_sources_(context, std::size_t(medium.channels) * (cut_count_ + rim_.cells) * sizeof(float), "cell sources"),
      facet_offsets_(context, std::size_t(medium.channels) * cut_count_ * sizeof(float), "facet corrections"),
      options_(options),
      multigrid_(context, solver_passes, domain.frame.cells, medium.channels, active_cells(context, domain),
                 options.multigrid),
      pcg_(context, solver_passes, multigrid_, options) {
  gpu::Commands commands(context);
  commands.fill(scales_);
  commands.dispatch(passes_.points, {cut_count_, 1, 1},
                    {{"cut_index", domain_.cut_index}, {"cut_cells", domain_.cut_cells}, {"points", points_}},
                    surface_push());
  commands.submit();
  if (options.history) history_.emplace(context, solver_passes, multigrid_, pcg_);
  set_medium(std::move(medium));
}

void Diffusion::set_medium(MediumSamples medium) {
  kappa_scale_ = medium.kappa_scale;
  gpu::upload(context_, multigrid_.finest().stencil, medium.kappa);
  gpu::upload(context_, kappa_, medium.cell_kappa);
  gpu::upload(context_, absorption_, medium.absorption);
  gpu::upload(context_, facets_, medium.facets);
  medium = {};  // the set-up that follows is where host memory peaks
  const OperatorPush push{domain_.frame.cells, cut_count_, glm::vec3(A_ * kappa_scale_ / double(domain_.frame.h)),
                          glm::vec3(kappa_scale_)};
  gpu::Commands commands(context_);
  {
    const auto scope = commands.time("diffusion operator");
    commands.dispatch(passes_.conductances, {cut_count_, multigrid_.channels(), 1},
                      {{"cut_index", domain_.cut_index},
                       {"cut_cells", domain_.cut_cells},
                       {"facets", facets_},
                       {"conductances", conductances_}},
                      push);
    commands.dispatch(passes_.assemble, multigrid_.threads(0),
                      {{"bricks", multigrid_.bricks().packed},
                       {"cut_index", domain_.cut_index},
                       {"cut_cells", domain_.cut_cells},
                       {"volume", domain_.volume},
                       {"aperture_x", domain_.aperture[0]},
                       {"aperture_y", domain_.aperture[1]},
                       {"aperture_z", domain_.aperture[2]},
                       {"points", points_},
                       {"absorption", absorption_},
                       {"stencil", multigrid_.finest().stencil},
                       {"conductances", conductances_}},
                      push);
  }
  commands.submit();
  multigrid_.refresh();
  if (history_) history_->forget();
}

void Diffusion::forget() {
  pcg_.clear_solution();
  gpu::Commands commands(context_);
  commands.fill(scales_);  // no unit of before: its corrections are none for the next solve
  commands.submit();
  if (history_) history_->forget();
}

SurfacePush Diffusion::surface_push(int sides) const {
  return {domain_.frame.cells, cut_count_, multigrid_.channels(), static_cast<float>(A_), static_cast<float>(f_dt_),
          domain_.frame.h,     sides};
}

void Diffusion::record_source(gpu::Commands& commands, const FacetLight& light, bool corrected) {
  const auto scope = commands.time("diffusion source");
  commands.dispatch(passes_.facets[corrected], {cut_count_, multigrid_.channels(), 1},
                    {{"cut_index", domain_.cut_index},
                     {"cut_cells", domain_.cut_cells},
                     {"conductances", conductances_},
                     {"gamma_s", light.gamma_s},
                     {"facets", facets_},
                     {"scales", scales_},
                     {"gradients", gradients_},
                     {"points", points_},
                     {"stencil", multigrid_.finest().stencil},
                     {"cell_sources", cell_sources_},
                     {"face_fluxes", face_fluxes_},
                     {"facet_offsets", facet_offsets_}},
                    surface_push(light.sides));
  const SourcePush push{domain_.frame.cells, cut_count_, rim_.cells, rim_.texels,
                        glm::vec3(1.0 / (kappa_scale_ * double(domain_.frame.h)))};
  if (corrected)
    commands.dispatch(passes_.rim, {rim_.cells, multigrid_.channels(), 1},
                      {{"rim_cells", rim_.cell_table}, {"face_fluxes", face_fluxes_}, {"cell_sources", cell_sources_}},
                      push);
  if (light.volume)
    commands.dispatch(passes_.power, multigrid_.threads(0),
                      {{"bricks", multigrid_.bricks().packed},
                       {"scales", scales_},
                       {"volume_power", *light.volume},
                       {"rhs", pcg_.rhs()}},
                      push);
  else if (power_in_cells_)
    commands.clear(pcg_.rhs());
  power_in_cells_ = light.volume != nullptr;
  commands.dispatch(passes_.source[corrected][power_in_cells_], {rim_.texels, multigrid_.channels(), 1},
                    {{"rim_texels", rim_.texel_table}, {"cell_sources", cell_sources_}, {"rhs", pcg_.rhs()}}, push);
}

void Diffusion::record_rescale(gpu::Commands& commands) {
  commands.dispatch(passes_.rescale, multigrid_.threads(0),
                    {{"bricks", multigrid_.bricks().packed},
                     {"scales", scales_},
                     {"high", pcg_.solution()},
                     {"low", pcg_.solution_rest()}},
                    surface_push());
}

void Diffusion::record_gradients(gpu::Commands& commands, const FacetLight& light) {
  const auto scope = commands.time("diffusion gradients");
  commands.dispatch(passes_.gradient, {cut_count_, multigrid_.channels(), 1},
                    {{"cut_index", domain_.cut_index},
                     {"cut_cells", domain_.cut_cells},
                     {"conductances", conductances_},
                     {"gamma_s", light.gamma_s},
                     {"facets", facets_},
                     {"scales", scales_},
                     {"volume", domain_.volume},
                     {"phi", pcg_.solution()},
                     {"points", points_},
                     {"gradients", gradients_}},
                    surface_push(light.sides));
}

void Diffusion::record_surface(gpu::Commands& commands, const FacetLight& light) {
  const auto scope = commands.time("diffusion surface");
  if (!near_cells_) {  // not before: the set-up is where memory peaks
    const NearSurface near = find_near_surface(context_, domain_);
    near_cells_ = gpu::make_buffer(context_, near.cells, "cells near the surface");
    cut_neighbours_ = gpu::make_buffer(context_, near.neighbours, "cut cells around them");
    for (int side = 0; side < 2; ++side) {
      commands.clear(surface_[side], {0, 0, 0, 1});
      commands.clear(surface_gamma_[side]);
    }
  }
  commands.dispatch(passes_.carry, {cut_count_, multigrid_.channels(), 1},
                    {{"cut_index", domain_.cut_index},
                     {"cut_cells", domain_.cut_cells},
                     {"gradients", gradients_},
                     {"gamma_s", light.gamma_s},
                     {"query_gamma", *light.query},
                     {"facets", facets_},
                     {"lines", lines_},
                     {"side_lights", side_lights_}},
                    surface_push(light.sides));
  commands.dispatch(passes_.inner[multigrid_.channels() == 3], {multigrid_.bricks().count * 8, 1, 1},
                    {{"bricks", multigrid_.bricks().packed},
                     {"scales", scales_},
                     {"phi", pcg_.solution()},
                     {"phi_up", surface_[0]},
                     {"phi_down", surface_[1]}},
                    surface_push());
  commands.dispatch(passes_.surface[multigrid_.channels() == 3], {near_cells_.bytes() / sizeof(NearCell), 1, 1},
                    {{"cut_index", domain_.cut_index},
                     {"cut_cells", domain_.cut_cells},
                     {"scales", scales_},
                     {"volume", domain_.volume},
                     {"phi", pcg_.solution()},
                     {"near_cells", near_cells_},
                     {"cut_neighbours", cut_neighbours_},
                     {"points", points_},
                     {"lines", lines_},
                     {"side_lights", side_lights_},
                     {"phi_up", surface_[0]},
                     {"phi_down", surface_[1]},
                     {"gamma_up", surface_gamma_[0]},
                     {"gamma_down", surface_gamma_[1]}},
                    surface_push());
}

// Puts the units of fluence in place. True where the solution and the gradients of before are of use for this light.
bool Diffusion::adopt_light(const FacetLight& light) {
  gpu::Commands commands(context_);
  commands.dispatch(passes_.scale, {256 * multigrid_.channels(), 1, 1},
                    {{"gamma_s", *light.entered}, {"scales", scales_}}, surface_push(light.sides));
  commands.submit();
  const FluenceScale* scales = static_cast<const FluenceScale*>(scales_.mapped());
  return std::all_of(scales, scales + multigrid_.channels(),
                     [](const FluenceScale& s) { return s.ratio >= 0.25f && s.ratio <= 4; });
}

// The corrections converge about as fast as the solver does, so the early solves need no more digits than they bring. A
// start whose gradients are known makes its own: each pass leaves a tenth of what was amiss, and what 1e-3 of the
// residual leaves amiss is some 2e-4 of the fluence at 64 cells, no more than what the grid itself does.
SolverStatus Diffusion::solve(const FacetLight& light, bool last) {
  SolverStatus status;
  int iterations = 0, corrections = options_.corrections;
  bool warm = adopt_light(light);
  for (int pass = 0; pass <= corrections; ++pass) {
    gpu::Commands commands(context_);
    if (pass == 0) record_rescale(commands);
    if (pass > 0) record_gradients(commands, light);
    record_source(commands, light, options_.corrections > 0 && (pass > 0 || warm));
    commands.submit();
    if (history_ && pass == 0 && history_->guess() && corrections > 0) {
      gpu::Commands again(context_);
      record_gradients(again, light);
      record_source(again, light, true);
      again.submit();
      warm = true;
    }
    if (pass == corrections)
      status = pcg_.solve();
    else if (warm && pass == 0)
      status = pcg_.solve({.near = nearly_there, .first = well_begun});
    else
      status = pcg_.solve({std::max(options_.tolerance, std::pow(10.0, -2 - pass)), true});
    iterations += status.iterations;
    if (warm && pass == 0)
      corrections = std::min(corrections, status.began_at <= nearly_there   ? 0
                                          : status.began_at <= nearly_right ? 1
                                                                            : 2);
  }
  status.iterations = iterations;
  if (history_ && status.converged) history_->add();
  if (last) {
    history_.reset();
    multigrid_.release();
  }
  gpu::Commands commands(context_);
  record_gradients(commands, light);
  record_surface(commands, light);
  commands.submit();
  return status;
}

SolverStatus Diffusion::approach(const FacetLight& light, double tolerance) {
  const bool warm = adopt_light(light);
  gpu::Commands before(context_);
  record_rescale(before);
  record_source(before, light, options_.corrections > 0 && warm);
  before.submit();
  const SolverStatus status = pcg_.solve({tolerance});
  gpu::Commands after(context_);
  record_gradients(after, light);
  after.submit();
  return status;
}

void Diffusion::record_exit(gpu::Commands& commands, const FacetLight& light, double exit_scale,
                            const gpu::Buffer& radiance, std::uint32_t first) {
  commands.dispatch(passes_.exit[light.through != nullptr], {2 * cut_count_, 1, 1},
                    {{"cut_index", domain_.cut_index},
                     {"cut_cells", domain_.cut_cells},
                     {"gamma_s", light.gamma_s},
                     {"query_gamma", *light.query},
                     {"through", light.through ? *light.through : *light.query},
                     {"facets", facets_},
                     {"scales", scales_},
                     {"phi", pcg_.solution()},
                     {"facet_offsets", facet_offsets_},
                     {"transmitted", radiance}},
                    ExitPush{surface_push(light.sides), static_cast<float>(exit_scale), first});
}

EnergyBalance Diffusion::energy(const FacetLight& light) {
  gpu::Commands commands(context_);
  const LevelPush level{domain_.frame.cells, domain_.frame.cells, 0};
  commands.dispatch(passes_.absorbed, multigrid_.threads(0),
                    {{"bricks", multigrid_.bricks().packed},
                     {"partials", pcg_.partials()},
                     {"volume", domain_.volume},
                     {"absorption", absorption_},
                     {"phi", pcg_.solution()}},
                    level);
  commands.dispatch(passes_.energy, {256 * multigrid_.channels(), 1, 1},
                    {{"cut_index", domain_.cut_index},
                     {"cut_cells", domain_.cut_cells},
                     {"gamma_s", light.gamma_s},
                     {"query_gamma", *light.query},
                     {"facets", facets_},
                     {"scales", scales_},
                     {"partials", pcg_.partials()},
                     {"facet_offsets", facet_offsets_},
                     {"phi", pcg_.solution()},
                     {"sums", energy_sums_}},
                    EnergyPush{surface_push(light.sides), pcg_.partials_per_channel()});
  commands.submit();
  const FluenceScale* scales = static_cast<const FluenceScale*>(scales_.mapped());
  const EnergySums* sums = static_cast<const EnergySums*>(energy_sums_.mapped());
  EnergyBalance balance;
  for (int c = 0; c < 3; ++c) {
    const int channel = std::min(c, multigrid_.channels() - 1);
    balance.in[c] = sums[channel].in_ + light.volume_power[channel];
    balance.out[c] = sums[channel].out_;
    balance.absorbed[c] =
        double(sums[channel].absorbed) * scales[channel].unit * kappa_scale_[channel] * domain_.frame.h;
  }
  return balance;
}

}  // namespace alabaster

#include "pipeline/render.h"

#include <algorithm>
#include <chrono>
#include <memory>

#include "lighting/beam_source.h"
#include "lighting/directional_source.h"
#include "lighting/facet_source.h"

namespace alabaster {
namespace {

/// Adds the wall-clock time it lives to a stage.
class Stage {
 public:
  Stage(RenderResult& result, const std::string& name) : milliseconds_(result.stages[name]) {}
  ~Stage() {
    milliseconds_ += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

 private:
  double& milliseconds_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Everything that lives as long as one object's fluence is wanted. The parts refer to each other: it does not move.
struct Body {
  std::size_t object = 0;
  Domain domain;
  std::unique_ptr<Diffusion> diffusion;
  std::unique_ptr<FacetSource> source;  // of these, the transport's
  std::unique_ptr<DirectionalSource> directional;
  std::unique_ptr<BeamSource> beam;
  std::unique_ptr<GatherExit> gather;
};

void make_source(gpu::Context& context, Transport transport, Body& body) {
  if (transport == Transport::directional)
    body.directional = std::make_unique<DirectionalSource>(context, body.domain);
  else if (transport == Transport::beam || transport == Transport::gather)
    body.beam = std::make_unique<BeamSource>(context, body.domain, body.diffusion->channels());
  else
    body.source = std::make_unique<FacetSource>(context, body.domain);
}

/// Records the object's light; what it returns holds once the commands have run.
FacetLight record_light(gpu::Commands& commands, const Lighting& lighting, const Body& body, double eta) {
  const Diffusion& d = *body.diffusion;
  const gpu::Buffer& media = d.facet_medium();
  if (body.beam) {
    body.beam->record(commands, lighting, {d.kappa(), d.absorption(), media, d.kappa_scale(), d.channels()}, eta);
    FacetLight light(body.beam->gamma_s(), 2);
    light.query = &body.beam->query_gamma();
    light.entered = &body.beam->entered();
    light.volume = &body.beam->power();
    return light;
  }
  if (body.directional) {
    body.directional->record(commands, lighting, media, eta);
    FacetLight light(body.directional->gamma_s(), 2);
    light.query = &body.directional->query_gamma();
    light.entered = &body.directional->entered();
    return light;
  }
  body.source->record(commands, lighting, media, eta);
  return FacetLight(body.source->gamma_s(), 2);
}

/// From the diffuse field's balance to all light's. The near light's boundary source feeds the field, carried on to the
/// surface, what that absorbs too much (shared/beam.h): it is in both sums and taken out of both.
void add_beams(const BeamTotals& beams, EnergyBalance& energy) {
  const glm::dvec3 too_much = energy.in - (beams.near + beams.in_cells);
  energy.in = beams.entered;
  energy.absorbed += beams.absorbed - too_much;
  energy.out += beams.through;
}

FacetLight make_light(gpu::Context& context, const Lighting& lighting, Body& body, double eta, RenderResult& result) {
  Stage stage(result, "gamma_s");
  gpu::Commands commands(context);
  FacetLight light = record_light(commands, lighting, body, eta);
  commands.submit();
  if (body.beam) light.volume_power = body.beam->totals().in_cells;
  return light;
}

void solve(gpu::Context& context, const Lighting& lighting, Body& body, double eta, RenderResult& result) {
  const FacetLight light = make_light(context, lighting, body, eta, result);
  Stage stage(result, "solve");
  ObjectReport& report = result.objects.emplace_back();
  report.solver = body.diffusion->solve(light);
  report.energy = body.diffusion->energy(light);
  if (body.beam) add_beams(body.beam->totals(), report.energy);
  if (!body.gather) return;
  gpu::Commands commands(context);
  body.gather->record(commands);
  commands.submit();
}

using Bodies = std::vector<std::unique_ptr<Body>>;

void report_on(const Object& object, const Body& body, int channels, RenderResult& result) {
  ObjectReport& report = result.objects.back();
  report.name = object.name;
  report.cells = body.domain.frame.cells;
  report.domain = body.domain.summary;
  report.levels = static_cast<int>(body.diffusion->multigrid().levels().size());
  report.channels = channels;
  for (const std::string& warning : body.domain.warnings) result.warnings.push_back(object.name + ": " + warning);
  if (!report.solver.converged) result.warnings.push_back(object.name + ": " + report.solver.reason);
}

/// What the lights send to the facets. The environment is left out: light between surfaces sees to it.
void gather_lights(gpu::Context& context, const Lighting& lighting, const std::vector<LitBody>& bodies) {
  gpu::Commands commands(context);
  for (const LitBody& body : bodies) {
    body.source.record_direct(commands, lighting, body.eta, false);
    body.source.record_source(commands, body.diffusion.facet_medium());
  }
  commands.submit();
}

/// What enters again is in neither `in` nor `out`.
void report_exchange(const Interreflections& passes, RenderResult& result) {
  result.exchange = passes.report();
  for (std::size_t i = 0; i < result.objects.size(); ++i) {
    ObjectReport& report = result.objects[i];
    report.reentered = passes.reentered(i);
    report.energy.in = passes.from_lights(i);
    report.energy.out -= report.reentered;
  }
}

/// Gamma_s and fluence of all bodies, with the light that surfaces send each other.
void solve_together(gpu::Context& context, const Scene& scene, const Lighting& lighting, const Plan& plan,
                    const Bodies& bodies, RenderResult& result) {
  std::vector<LitBody> lit;
  for (const auto& body : bodies)
    lit.push_back({static_cast<int>(body->object), scene.objects[body->object].eta, body->domain, *body->diffusion,
                   *body->source});
  {
    Stage stage(result, "gamma_s");
    gather_lights(context, lighting, lit);
  }
  std::unique_ptr<Interreflections> passes;
  {
    Stage stage(result, "links");
    passes = std::make_unique<Interreflections>(context, scene, lighting, plan, lit);
  }
  {
    Stage stage(result, "interreflections");
    passes->approach();
  }
  for (std::size_t i = 0; i < lit.size(); ++i) {
    Stage stage(result, "solve");
    ObjectReport& report = result.objects.emplace_back();
    report.solver = lit[i].diffusion.solve(lit[i].light());
    report.energy = lit[i].diffusion.energy(lit[i].light());
    report_on(scene.objects[lit[i].object], *bodies[i], plan.channels, result);
  }
  Stage stage(result, "interreflections");
  passes->settle();
  report_exchange(*passes, result);
}

/// R, G, B become the sum of the wanted layers; the others' planes are emptied.
void keep_components(const std::set<Component>& wanted, Picture& picture) {
  for (Component component : {Component::multiple, Component::surface}) {
    if (wanted.count(component)) continue;
    for (const char* channel : {"R", "G", "B"}) {
      std::vector<float>&layer = picture.plane(std::string(name_of(component)) + "." + channel),
      &sum = picture.plane(channel);
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] -= layer[i];
      std::fill(layer.begin(), layer.end(), 0.0f);
    }
  }
}

}  // namespace

RenderResult render_scene(gpu::Context& context, const Scene& scene, const Plan& plan) {
  RenderResult result;
  std::unique_ptr<DomainMaker> domains;
  std::unique_ptr<DiffusionPasses> solver_passes;
  std::unique_ptr<FluencePasses> fluence_passes;
  std::unique_ptr<Shading> shading;
  {
    Stage stage(result, "pipelines");
    domains = std::make_unique<DomainMaker>(context);
    solver_passes = std::make_unique<DiffusionPasses>(context);
    fluence_passes = std::make_unique<FluencePasses>(context);
    shading = std::make_unique<Shading>(context);
  }

  std::unique_ptr<SceneMeshes> meshes;
  std::unique_ptr<Lighting> lighting;
  {
    Stage stage(result, "shadow maps");
    meshes = std::make_unique<SceneMeshes>(upload_meshes(context, scene));
    lighting = std::make_unique<Lighting>(
        context, scene, *meshes, LightSettings{plan.light_samples, plan.environment_samples, plan.shadow_map_size});
    gpu::Commands commands(context);
    lighting->record_shadow_maps(commands);
    commands.submit();
  }

  SolverOptions options;
  options.tolerance = plan.tolerance;
  Bodies bodies;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const Object& object = scene.objects[i];
    if (object.role != Role::translucent) continue;
    Body& body = *bodies.emplace_back(std::make_unique<Body>());
    body.object = i;
    {
      Stage stage(result, "cut cells");
      body.domain = domains->make(object.mesh, choose_frame(bounds_of(object.mesh), plan.grid));
    }
    MediumSamples medium;
    {
      Stage stage(result, "medium");
      medium = sample_medium(context, body.domain, field_of(object.medium), plan.channels);
      for (const std::string& warning : medium.warnings) result.warnings.push_back(object.name + ": " + warning);
    }
    {
      Stage stage(result, "solver set-up");
      body.diffusion = std::make_unique<Diffusion>(context, *solver_passes, *fluence_passes, body.domain, medium,
                                                   object.eta, options);
      make_source(context, plan.transport, body);
      if (plan.transport == Transport::gather)
        body.gather = std::make_unique<GatherExit>(context, body.domain, *body.diffusion, *body.beam, object.eta);
    }
  }
  if (plan.interreflections > 0 && !bodies.empty()) {
    solve_together(context, scene, *lighting, plan, bodies, result);
  } else {
    for (const auto& body : bodies) {
      solve(context, *lighting, *body, scene.objects[body->object].eta, result);
      report_on(scene.objects[body->object], *body, plan.channels, result);
    }
  }

  Stage stage(result, "shade");
  Shading::Input input{scene,
                       *meshes,
                       *lighting,
                       {},
                       plan.camera,
                       {plan.size},
                       plan.transport == Transport::as_printed ? Exit::as_printed : Exit::report};
  for (const auto& body : bodies) {
    const Diffusion& d = *body->diffusion;
    input.surfaces.push_back({static_cast<int>(body->object),
                              {&d.surface(0), &d.surface(1)},
                              {&d.surface_gamma(0), &d.surface_gamma(1)},
                              body->domain.frame,
                              body->gather.get()});
  }
  result.shaded = shading->shade(input);
  keep_components(plan.components, result.shaded.picture);
  return result;
}

}  // namespace alabaster

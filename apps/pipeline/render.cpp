#include "pipeline/render.h"

#include <algorithm>
#include <chrono>
#include <future>
#include <memory>

#include "pipeline/body_light.h"
#include "pipeline/short_ways.h"

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
  std::unique_ptr<BodyLight> light;
  std::unique_ptr<GatherExit> gather;
  std::unique_ptr<SingleScattering> single;  // where it is computed by itself
  std::unique_ptr<Straight> straight;
};
using Bodies = std::vector<std::unique_ptr<Body>>;

/// From the diffuse field's balance to all light's. The near light's boundary source feeds the field, carried on to the
/// surface, what that absorbs too much (shared/beam.h): it is in both sums and taken out of both. `surfaces` is what
/// enters diffusely, from other surfaces, W.
void add_beams(const BeamTotals& beams, glm::dvec3 surfaces, EnergyBalance& energy) {
  const glm::dvec3 too_much = energy.in - surfaces - (beams.near + beams.in_cells);
  energy.in = beams.entered + surfaces;
  energy.absorbed += beams.absorbed - too_much;
  energy.out += beams.through;
}

void report_on(const Object& object, const Body& body, int channels, ObjectReport& report, RenderResult& result) {
  report.name = object.name;
  report.cells = body.domain.frame.cells;
  report.domain = body.domain.summary;
  report.levels = static_cast<int>(body.diffusion->multigrid().levels().size());
  report.channels = channels;
  if (body.gather) report.gather_level = body.gather->levels().mean();
  for (const std::string& warning : body.domain.warnings) result.warnings.push_back(object.name + ": " + warning);
  if (!report.solver.converged) result.warnings.push_back(object.name + ": " + report.solver.reason);
}

/// What the lights send into the bodies that send each other nothing.
void light_bodies(gpu::Context& context, const Lighting& lighting, const Bodies& bodies, RenderResult& result) {
  Stage stage(result, "gamma_s");
  gpu::Commands commands(context);
  for (const auto& body : bodies) body->light->record_lights(commands, lighting);
  commands.submit();
}

/// The lights, and then passes until all light between the bodies' surfaces is among what drives them.
std::unique_ptr<Interreflections> light_each_other(gpu::Context& context, const Scene& scene, const Lighting& lighting,
                                                   const Plan& plan, const Bodies& bodies, RenderResult& result) {
  std::vector<LitBody> lit;
  for (const auto& body : bodies)
    lit.push_back({static_cast<int>(body->object), scene.objects[body->object].eta, body->domain, *body->diffusion,
                   *body->light});
  {
    Stage stage(result, "gamma_s");
    gpu::Commands commands(context);
    for (const auto& body : bodies) body->light->record_lamps(commands, lighting);
    commands.submit();
  }
  std::unique_ptr<Interreflections> passes;
  {
    Stage stage(result, "links");
    passes = std::make_unique<Interreflections>(context, scene, lighting, plan, lit);
  }
  {
    Stage stage(result, "gamma_s");
    passes->start();
  }
  Stage stage(result, "interreflections");
  passes->approach();
  return passes;
}

/// `surfaces`, W: what enters by the facets' boundary source, from other surfaces.
void solve(Body& body, glm::dvec3 surfaces, ObjectReport& report) {
  const FacetLight light = body.light->light();
  report.solver = body.diffusion->solve(light, true);
  report.energy = body.diffusion->energy(light);
  if (body.light->beam()) add_beams(body.light->beam()->totals(), surfaces, report.energy);
  if (body.gather) body.gather->update();
}

void solve_all(gpu::Context& context, const Scene& scene, const Lighting& lighting, const Plan& plan,
               const Bodies& bodies, RenderResult& result) {
  std::unique_ptr<Interreflections> passes;
  if (plan.interreflections > 0 && !bodies.empty())
    passes = light_each_other(context, scene, lighting, plan, bodies, result);
  else
    light_bodies(context, lighting, bodies, result);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Stage stage(result, "solve");
    ObjectReport& report = result.objects.emplace_back();
    solve(*bodies[i], passes ? passes->by_facets(i) : glm::dvec3(0), report);
    report_on(scene.objects[bodies[i]->object], *bodies[i], plan.channels, report, result);
    if (passes) report.energy.in -= passes->reentered(i);
  }
  if (!passes) return;
  Stage stage(result, "interreflections");
  passes->settle();
  result.exchange = passes->report();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    result.objects[i].reentered = passes->reentered(i);
    result.objects[i].energy.out -= passes->reentered(i);
  }
}

/// `multiple` carries `single` where that is not wanted by itself.
void fold_single(Picture& picture) {
  for (const char* channel : {"R", "G", "B"}) {
    const auto single = picture.channels.find(std::string("single.") + channel);
    if (single == picture.channels.end()) continue;
    std::vector<float>& multiple = picture.plane(std::string("multiple.") + channel);
    for (std::size_t i = 0; i < multiple.size(); ++i) multiple[i] += single->second[i];
    picture.channels.erase(single);
  }
}

/// R, G, B become the sum of the wanted layers; the others' planes are emptied.
void keep_components(const std::set<Component>& wanted, Picture& picture) {
  if (!wanted.count(Component::single)) fold_single(picture);
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
  return render_scene(context, Pipelines(context), scene, plan);
}

RenderResult render_scene(gpu::Context& context, const Pipelines& pipelines, const Scene& scene, const Plan& plan) {
  RenderResult result;
  const bool beams = plan.transport == Transport::beam || plan.transport == Transport::gather;
  pipelines.shading.begin(scene, plan.transport == Transport::gather, beams);
  std::unique_ptr<SceneMeshes> meshes;
  std::unique_ptr<Lighting> lighting;
  {
    Stage stage(result, "shadow maps");
    meshes = std::make_unique<SceneMeshes>(upload_surfaces(context, scene));
    lighting = std::make_unique<Lighting>(
        context, scene, *meshes, LightSettings{plan.light_samples, plan.environment_samples, plan.shadow_map_size});
    gpu::Commands commands(context);
    lighting->record_shadow_maps(commands);
    commands.submit();
  }
  // Made while the device works alone: the solver's set-up leaves a CPU's other threads to it.
  std::future<RayTree> tree;
  const auto begin_tree = [&] {
    if (!tree.valid() && !meshes->rays.nodes)
      tree = std::async(std::launch::async, [&] { return make_ray_tree(scene); });
  };
  const auto end_tree = [&] {
    if (tree.valid()) meshes->rays = upload_ray_tree(context, tree.get());
  };

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
      body.domain = pipelines.domains.make(object.mesh, choose_frame(bounds_of(object.mesh), plan.grid));
    }
    MediumSamples medium;
    {
      Stage stage(result, "medium");
      medium = sample_medium(context, body.domain, field_of(object.medium), plan.channels);
      for (const std::string& warning : medium.warnings) result.warnings.push_back(object.name + ": " + warning);
      const std::string warning = short_ways_warning(medium, body.domain.frame, plan.grid);
      if (!warning.empty()) result.warnings.push_back(object.name + ": " + warning);
    }
    begin_tree();
    {
      Stage stage(result, "solver set-up");
      body.diffusion = std::make_unique<Diffusion>(context, pipelines.solver, pipelines.fluence, body.domain,
                                                   std::move(medium), object.eta, options);
      body.light =
          std::make_unique<BodyLight>(context, plan.transport, object.mesh, body.domain, *body.diffusion, object.eta);
      if (body.light->beam())
        body.straight = std::make_unique<Straight>(context, body.domain, *body.diffusion, object.eta);
      if (plan.transport == Transport::gather)
        body.gather = std::make_unique<GatherExit>(context, body.domain, *body.diffusion, *body.light->beam(),
                                                   meshes->rays, object.eta);
      else if (plan.components.count(Component::single))
        body.single = std::make_unique<SingleScattering>(
            context, body.domain, *body.diffusion,
            SingleScattering::Subject{static_cast<int>(i), object.medium, object.eta});
      end_tree();
      if (body.single) {
        body.single->prepare(*lighting, *meshes);
        body.light->take_out(*body.single);
      }
    }
  }
  begin_tree();
  end_tree();
  solve_all(context, scene, *lighting, plan, bodies, result);

  Stage stage(result, "shade");
  Shading::Input input{scene,
                       *meshes,
                       *lighting,
                       {},
                       plan.camera,
                       {plan.size, plan.pixel_samples},
                       plan.transport == Transport::as_printed ? Exit::as_printed : Exit::report};
  for (const auto& body : bodies) {
    const Diffusion& d = *body->diffusion;
    input.surfaces.push_back({static_cast<int>(body->object),
                              {&d.surface(0), &d.surface(1)},
                              {&d.surface_gamma(0), &d.surface_gamma(1)},
                              body->domain.frame,
                              body->gather.get(),
                              body->single.get(),
                              body->straight.get()});
  }
  result.shaded = pipelines.shading.shade(input);
  keep_components(plan.components, result.shaded.picture);
  return result;
}

}  // namespace alabaster

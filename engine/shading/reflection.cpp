#include "shading/reflection.h"

#include <algorithm>

#include "scene/error.h"
#include "scene/rough_lobe.h"
#include "shared/optics.h"

namespace alabaster {

static_assert(sizeof(MirroredObject) == 72 && sizeof(Emitter) == 44 && sizeof(GlowPush) == 28 &&
              sizeof(ReflectionPush) == 104);

namespace {

constexpr const char *reflection_shader = "shading/reflection.comp", *straight_shader = "shading/straight.comp";

float largest(glm::vec3 v) { return std::max({v.r, v.g, v.b}); }

std::uint32_t kind_of(Role role) {
  switch (role) {
    case Role::opaque:
      return mirrored_opaque;
    case Role::emissive:
      return mirrored_emissive;
    case Role::translucent:
      return mirrored_translucent;
  }
  return mirrored_opaque;
}

/// Triangles of the area lights, each picked in proportion to its area times the largest channel of its radiance.
std::vector<Emitter> emitters_of(const Scene& scene, double& power) {
  std::vector<Emitter> emitters;
  std::vector<double> below;
  power = 0;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const Object& object = scene.objects[i];
    if (object.role != Role::emissive || !(largest(object.radiance) > 0)) continue;
    for (const glm::uvec3& t : object.mesh.triangles) {
      const glm::vec3 a = object.mesh.positions[t.x], ab = object.mesh.positions[t.y] - a,
                      ac = object.mesh.positions[t.z] - a;
      emitters.push_back({a, ab, ac, 0, static_cast<uint>(i)});
      below.push_back(power);
      power += 0.5 * glm::length(glm::cross(glm::dvec3(ab), glm::dvec3(ac))) * largest(object.radiance);
    }
  }
  for (std::size_t i = 0; i < emitters.size(); ++i) emitters[i].below = static_cast<float>(below[i] / power);
  return emitters;
}

MirroredObject mirrored_object(const Object& object, double light_power) {
  MirroredObject m{};
  m.kind = kind_of(object.role);
  m.colour = object.role == Role::emissive ? object.radiance : object.albedo;
  m.two_sided = object.two_sided;
  if (light_power > 0) m.light_density = static_cast<float>(largest(object.radiance) / light_power);
  m.eta = object.role == Role::translucent ? static_cast<float>(object.eta) : 1.0f;
  m.glow_z = glm::vec2(-1);
  return m;
}

bool rough(const Object& object) {
  return object.role == Role::translucent && object.eta != 1 && object.roughness >= least_roughness;
}

gpu::Image glow_image(gpu::Context& context, glm::ivec3 size) {
  const auto most = static_cast<int>(context.limits().maxImageDimension3D);
  if (size.z > most)
    throw UserError("picture: the grids of all translucent objects together are " + std::to_string(size.z / 2) +
                    " cells deep where " + context.info().name + " allows " + std::to_string(most / 2) +
                    " to be mirrored; choose a smaller --grid");
  return gpu::image3d(context, size, VK_FORMAT_R16G16B16A16_SFLOAT, "glow");
}

}  // namespace

Reflection::Reflection(gpu::Context& context)
    : context_(context), linear_(context, gpu::Filter::linear), glow_(context, "shading/glow.comp") {}

const gpu::Pass& Reflection::pass(const char* shader, const Scene& scene, bool listed) const {
  const bool any_rough = std::any_of(scene.objects.begin(), scene.objects.end(), rough),
             sky = scene.environment.radiance != glm::vec3(0);
  std::unique_ptr<gpu::Pass>& made = passes_[{shader, listed, any_rough, sky}];
  if (!made) made = std::make_unique<gpu::Pass>(context_, shader, gpu::Constants{listed, any_rough, sky});
  return *made;
}

void Reflection::begin(const Scene& scene) const { pass(reflection_shader, scene, false); }

void Reflection::begin_straight(const Scene& scene, bool listed) const { pass(straight_shader, scene, listed); }

MirroredScene Reflection::prepare(const Shading::Input& input) const {
  MirroredScene result;
  double light_power = 0;
  std::vector<Emitter> emitters = emitters_of(input.scene, light_power);
  result.emitter_count = static_cast<std::uint32_t>(emitters.size());
  emitters.resize(std::max<std::size_t>(emitters.size(), 1));

  std::vector<MirroredObject> objects;
  std::vector<float> lobes(input.scene.objects.size() * rough_entries);
  for (std::size_t i = 0; i < input.scene.objects.size(); ++i) {
    const Object& object = input.scene.objects[i];
    MirroredObject& m = objects.emplace_back(mirrored_object(object, light_power));
    if (!rough(object)) continue;
    const RoughLobe lobe = make_rough_lobe(object.roughness, object.eta);
    m.alpha = lobe.alpha;
    m.mean_deficit = lobe.mean_deficit;
    std::copy(lobe.albedo.begin(), lobe.albedo.end(), lobes.begin() + static_cast<std::ptrdiff_t>(i * rough_entries));
  }

  glm::ivec3 size(1, 1, 0);
  for (const TranslucentSurface& surface : input.surfaces) {
    const GridFrame& frame = surface.frame;
    result.glow_z.push_back(size.z);
    MirroredObject& m = objects[static_cast<std::size_t>(surface.object)];
    m.grid_low = frame.origin;
    m.per_metre = 1 / frame.h;
    m.grid_cells = glm::vec3(frame.cells);
    m.glow_z = glm::vec2(size.z, size.z + frame.cells.z);
    size = {glm::max(glm::ivec2(size), glm::ivec2(frame.cells)), size.z + 2 * frame.cells.z};
  }
  size.z = std::max(size.z, 1);
  result.glow = glow_image(context_, size);
  result.objects = gpu::make_buffer(context_, objects, "mirrored objects");
  result.emitters = gpu::make_buffer(context_, emitters, "emitters");
  result.lobes = gpu::make_buffer(context_, lobes, "rough lobes");
  return result;
}

void Reflection::record_glow(gpu::Commands& commands, const Shading::Input& input,
                             const MirroredScene& mirrored) const {
  const auto timer = commands.time("glow");
  for (std::size_t i = 0; i < input.surfaces.size(); ++i) {
    const TranslucentSurface& surface = input.surfaces[i];
    const double eta = input.scene.objects[static_cast<std::size_t>(surface.object)].eta;
    const double f_dr = internal_diffuse_reflectance(eta);
    GlowPush push;
    push.cells = surface.frame.cells;
    push.z = mirrored.glow_z[i];
    push.A = static_cast<float>(boundary_constant(f_dr));
    push.f_dt = static_cast<float>(1 - f_dr);
    push.exit_scale = input.exit == Exit::as_printed ? 1.0f : static_cast<float>(1 / (eta * eta));
    commands.dispatch(glow_, glm::uvec3(push.cells),
                      {{"phi_up", *surface.fluence[0], linear_},
                       {"phi_down", *surface.fluence[1], linear_},
                       {"gamma_up", *surface.gamma_s[0], linear_},
                       {"gamma_down", *surface.gamma_s[1], linear_},
                       {"glow", mirrored.glow}},
                      push);
  }
}

ReflectionPush Reflection::push(const Shading::Input& input, const MirroredScene& mirrored,
                                const Target& target) const {
  const SceneMeshes::Range& range = input.meshes.ranges[static_cast<std::size_t>(target.surface.object)];
  ReflectionPush push;
  push.camera = target.camera;
  push.corner = target.corner;
  push.first = range.first;
  push.count = range.count;
  push.object = static_cast<std::uint32_t>(target.surface.object);
  push.first_sample = 0;
  push.end_sample = target.camera.edge * target.camera.edge;
  push.rays = static_cast<std::uint32_t>(input.rough_rays);
  push.emitters = mirrored.emitter_count;
  push.orders = static_cast<std::uint32_t>(input.mirrorings);
  push.environment_turn = input.lighting.environment_turn();
  return push;
}

gpu::Bindings Reflection::bindings(const Shading::Input& input, const MirroredScene& mirrored,
                                   const Target& target) const {
  gpu::Bindings bindings = target.shared;
  for (const gpu::Binding& light : input.lighting.bindings()) bindings.push_back(light);
  for (const gpu::Binding& tree : input.meshes.rays.bindings()) bindings.push_back(tree);
  bindings.push_back(input.lighting.environment_binding());
  bindings.push_back({"objects", mirrored.objects});
  bindings.push_back({"glow", mirrored.glow, linear_});
  bindings.push_back({"emitters", mirrored.emitters});
  bindings.push_back({"lobes", mirrored.lobes});
  return bindings;
}

void Reflection::record(gpu::Commands& commands, const Shading::Input& input, const MirroredScene& mirrored,
                        const Target& target) const {
  ReflectionPush part = push(input, mirrored, target);
  const gpu::Bindings all = bindings(input, mirrored, target);
  const gpu::Pass& reflection = pass(reflection_shader, input.scene, false);
  const auto timer = commands.time("reflection");
  // Lavapipe ends an invocation after 65535 turns of its loops, all taken together: only a few samples go at once, and
  // rough ones one by one.
  const std::uint32_t samples = part.end_sample;
  const std::uint32_t at_once = rough(input.scene.objects[part.object]) ? 1u : std::min(samples, 4u);
  for (part.first_sample = 0; part.first_sample < samples; part.first_sample += at_once) {
    part.end_sample = std::min(part.first_sample + at_once, samples);
    commands.dispatch(reflection, {target.extent, 1}, all, part);
  }
}

void Reflection::record_straight(gpu::Commands& commands, const Shading::Input& input, const MirroredScene& mirrored,
                                 const Target& target, const gpu::Buffer* open) const {
  gpu::Bindings all = bindings(input, mirrored, target);
  all.push_back({"open_groups", open ? *open : mirrored.objects});
  for (const gpu::Binding& binding : target.surface.straight->bindings()) all.push_back(binding);
  const auto timer = commands.time("straight");
  const gpu::Pass& straight = pass(straight_shader, input.scene, open != nullptr);
  // One by one as above: ways through a thin object are long.
  ReflectionPush part = push(input, mirrored, target);
  const std::uint32_t samples = part.end_sample;
  for (part.first_sample = 0; part.first_sample < samples; ++part.first_sample) {
    part.end_sample = part.first_sample + 1;
    if (open)
      commands.dispatch_indirect(straight, *open, all, part);
    else
      commands.dispatch(straight, {target.extent, 1}, all, part);
  }
}

}  // namespace alabaster

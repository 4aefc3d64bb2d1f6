#include "lighting/lighting.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lighting/shadow_views.h"
#include "scene/error.h"

namespace alabaster {

static_assert(sizeof(Receiver) == 28 && sizeof(LightPoint) == 56 && sizeof(ShadowView) == 68 &&
              sizeof(LightingHeader) == 28);

namespace {

gpu::RasterOptions depth_only(VkCullModeFlags cull) {
  gpu::RasterOptions options;
  options.depth = VK_FORMAT_D32_SFLOAT;
  options.cull = cull;
  return options;
}

double distance(const Bounds& box, glm::vec3 p) {
  return glm::length(glm::max(glm::max(box.low - p, p - box.high), glm::vec3(0)));
}

gpu::Image depth_maps(gpu::Context& context, int size, std::size_t layers) {
  if (size < 16) throw UserError("shadow maps: " + std::to_string(size) + " texels along an edge; choose 16 or more");
  gpu::ImageSpec spec;
  spec.size = {size, size, 1};
  spec.format = VK_FORMAT_D32_SFLOAT;
  spec.type = VK_IMAGE_TYPE_2D;
  spec.usage =
      VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  spec.layers = static_cast<std::uint32_t>(std::max<std::size_t>(layers, 2));  // one layer would not be an array
  if (spec.layers > context.limits().maxImageArrayLayers)
    throw gpu::DeviceError("shadow maps: " + std::to_string(spec.layers) + " where " + context.info().name +
                           " allows " + std::to_string(context.limits().maxImageArrayLayers) +
                           "; choose fewer light samples");
  return gpu::Image(context, spec, "shadow maps");
}

}  // namespace

Lighting::Lighting(gpu::Context& context, const Scene& scene, const SceneMeshes& meshes, const LightSettings& settings)
    : context_(context),
      meshes_(meshes),
      samples_(sample_lights(scene, settings.samples, settings.directions)),
      compare_(context, gpu::Filter::linear, true),
      nearest_(context, gpu::Filter::nearest),
      closed_casters_(context, "lighting/shadow.vert", "lighting/shadow.frag", depth_only(VK_CULL_MODE_BACK_BIT)),
      open_casters_(context, "lighting/shadow.vert", "lighting/shadow.frag", depth_only(VK_CULL_MODE_NONE)) {
  for (const Object& object : scene.objects) closed_.push_back(object.role == Role::translucent);
  make_views(scene, settings);
  const auto need = [&](int part) {
    if (!gather_[part])
      gather_[part] = std::make_unique<gpu::Pass>(context, "lighting/gather.comp", gpu::Constants{part});
  };
  for (const glm::uvec2& maps : point_maps_) need(maps.y == 1 ? gather_one_map : gather_other_maps);
  if (samples_.environment != glm::vec3(0)) need(gather_directions);
  upload_environment(scene.environment);
  shadow_maps_ = depth_maps(context, settings.map_size, views_.size());
}

void Lighting::make_views(const Scene& scene, const LightSettings& settings) {
  const Focus focus = shadow_focus(scene);
  Bounds everything;
  for (const SceneMeshes::Range& range : meshes_.ranges)
    if (range.count) everything.add(range.bounds.low), everything.add(range.bounds.high);

  std::vector<ShadowView> views;
  const auto add = [&](const ShadowView& view, int skip) {
    views.push_back(view);
    views_.push_back({view.to_clip, skip});
  };
  std::vector<LightPoint> points;
  for (const LightSample& sample : samples_.area) {
    const std::uint32_t first = static_cast<std::uint32_t>(views.size());
    double nearest = INFINITY;
    for (std::size_t i = 0; i < meshes_.ranges.size(); ++i)
      if (static_cast<int>(i) != sample.object && meshes_.ranges[i].count)
        nearest = std::min(nearest, distance(meshes_.ranges[i].bounds, sample.position));
    if (!std::isfinite(nearest)) nearest = 0;
    if (sample.kind == light_directional)
      add(direction_view(-sample.normal, focus, everything, settings.map_size), -1);
    else
      for (const ShadowView& view : point_views(sample, focus, nearest, settings.map_size)) add(view, sample.object);
    points.push_back({sample.position, sample.normal, sample.intensity, first,
                      static_cast<std::uint32_t>(views.size()) - first, sample.kind, sample.cone});
    point_maps_.push_back({points.back().first_view, points.back().views});
  }
  const LightingHeader header{
      static_cast<std::uint32_t>(points.size()), static_cast<std::uint32_t>(samples_.directions.size()),
      static_cast<std::uint32_t>(views.size()), static_cast<float>(settings.map_size), samples_.environment};
  for (const glm::vec3& direction : samples_.directions)
    add(direction_view(direction, focus, everything, settings.map_size), -1);

  if (views.size() > most_shadow_views)
    throw UserError(scene.path + ": light samples need " + std::to_string(views.size()) + " shadow maps where " +
                    std::to_string(most_shadow_views) + " are the most; choose fewer samples or directions");
  views.resize(most_shadow_views);
  std::vector<std::byte> bytes(sizeof header + most_light_points * sizeof(LightPoint));
  std::memcpy(bytes.data(), &header, sizeof header);
  if (!points.empty()) std::memcpy(bytes.data() + sizeof header, points.data(), points.size() * sizeof(LightPoint));
  lights_ = gpu::make_buffer(context_, bytes, "lights");
  view_buffer_ = gpu::make_buffer(context_, views, "shadow views");
}

void Lighting::upload_environment(const Environment& environment) {
  glm::ivec2 size(1);
  std::vector<glm::vec4> texels{glm::vec4(environment.radiance, 0)};
  if (environment.picture) {
    size = environment.picture->size();
    texels.clear();
    for (const glm::vec3& radiance : environment.picture->texels()) texels.emplace_back(radiance, 0);
    environment_turn_ = environment.picture->turn();
  }
  const auto most = static_cast<int>(context_.limits().maxImageDimension2D);
  if (std::max(size.x, size.y) > most)
    throw UserError("environment: the picture is larger than " + std::to_string(most) +
                    " pixels, which is the most for " + context_.info().name + "; scale it down");
  gpu::ImageSpec spec;
  spec.size = {size, 1};
  spec.format = VK_FORMAT_R32G32B32A32_SFLOAT;
  spec.type = VK_IMAGE_TYPE_2D;
  spec.usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  environment_ = gpu::Image(context_, spec, "environment");
  gpu::upload(context_, environment_, texels);
}

void Lighting::record_shadow_maps(gpu::Commands& commands) const {
  if (views_.empty()) return;
  const auto timer = commands.time("shadow maps");
  commands.concurrent([&] {
    for (std::uint32_t layer = 0; layer < views_.size(); ++layer) {
      gpu::Targets targets;
      targets.size = glm::ivec2(shadow_maps_.spec().size);
      targets.depth = &shadow_maps_;
      targets.depth_layer = layer;
      commands.begin_rendering(targets);
      for (std::size_t i = 0; i < meshes_.ranges.size(); ++i)
        if (static_cast<int>(i) != views_[layer].skip && meshes_.ranges[i].count)
          commands.draw(closed_[i] ? closed_casters_ : open_casters_, {}, meshes_.geometry(i), views_[layer].to_clip);
      commands.end_rendering();
    }
  });
}

struct Lighting::Gather {
  const gpu::Buffer &receivers, &flux;
  std::vector<std::uint32_t> shares;  // receivers of each
  double eta;
  bool environment;
};

void Lighting::record_gather(gpu::Commands& commands, const gpu::Buffer& receivers, std::uint32_t count, double eta,
                             const gpu::Buffer& flux, bool environment) const {
  record(commands, {receivers, flux, {count}, eta, environment});
}

void Lighting::record_shared_gather(gpu::Commands& commands, const gpu::Buffer& receivers,
                                    const std::vector<std::uint32_t>& shares, const gpu::Buffer& irradiance) const {
  record(commands, {receivers, irradiance, shares, 1, true});
}

void Lighting::record(gpu::Commands& commands, const Gather& gather) const {
  const auto timer = commands.time("gather");
  commands.fill(gather.flux);
  const std::uint32_t count = std::accumulate(gather.shares.begin(), gather.shares.end(), 0u);
  if (count == 0) return;
  const bool environment = gather.environment && samples_.environment != glm::vec3(0);
  const gpu::Buffer& openness =
      commands.keep(gpu::Buffer(context_, (environment ? count : 1) * sizeof(glm::vec2), "openness"));
  gpu::Bindings all = bindings();
  all.push_back({"receivers", gather.receivers});
  all.push_back({"flux", gather.flux});
  all.push_back({"environment", openness});
  GatherPush push{};
  push.eta = static_cast<float>(gather.eta);
  push.f_dt_outer = static_cast<float>(1 - diffuse_reflectance(gather.eta));
  push.step = static_cast<std::uint32_t>(gather.shares.size());
  for (push.point = 0; push.point < push.step; ++push.point) {
    push.receivers = gather.shares[push.point];
    if (push.receivers) record_points(commands, all, push);
    push.first += push.receivers;
  }
  if (!environment) return;
  commands.fill(openness);
  push.first = 0;
  push.receivers = count;
  record_directions(commands, all, push);
}

void Lighting::record_points(gpu::Commands& commands, const gpu::Bindings& bindings, GatherPush push) const {
  const glm::uvec3 threads(push.receivers, 1, 1);
  const auto points = static_cast<std::uint32_t>(point_maps_.size());
  for (; push.point < points; push.point += push.count * push.step) {
    push.map = point_maps_[push.point].x;
    push.count = 0;
    const auto follows = [&] {  // the next point has one map, and that lies as far on as the point
      const std::uint32_t on = push.count * push.step;
      return push.point + on < points && point_maps_[push.point + on] == glm::uvec2(push.map + on, 1);
    };
    while (push.count < gather_at_once && follows()) ++push.count;
    const int part = push.count ? gather_one_map : gather_other_maps;
    push.count = std::max(push.count, 1u);
    commands.dispatch(*gather_[part], threads, bindings, push);
  }
}

void Lighting::record_directions(gpu::Commands& commands, const gpu::Bindings& bindings, GatherPush push) const {
  const std::uint32_t end = maps(), first = end - static_cast<std::uint32_t>(samples_.directions.size());
  for (push.map = first; !push.last; push.map += push.count) {
    push.count = std::min(end - push.map, gather_at_once);
    push.last = push.map + push.count == end;
    commands.dispatch(*gather_[gather_directions], {push.receivers, 1, 1}, bindings, push);
  }
}

gpu::Bindings Lighting::bindings() const {
  return {{"lighting", lights_}, {"views", view_buffer_}, {"shadow_maps", shadow_maps_, compare_}};
}

}  // namespace alabaster

#include "shading/shading.h"

#include <tbb/task_group.h>

#include <algorithm>
#include <cmath>

#include "scene/error.h"
#include "shading/reflection.h"
#include "shared/optics.h"
#include "shared/shading.h"

namespace alabaster {

static_assert(sizeof(CameraRays) == 60 && sizeof(PlainObject) == 20 && sizeof(TranslucentPush) == 116 &&
              sizeof(SinglePush) == 124);

namespace {

constexpr VkFormat id_format = VK_FORMAT_R32_UINT;

gpu::RasterOptions id_and_depth() {
  gpu::RasterOptions options;
  options.color = {id_format};
  options.depth = VK_FORMAT_D32_SFLOAT;
  return options;
}

CameraRays camera_rays(const Camera& camera, const Frame& frame) {
  const float tangent = std::tan(0.5f * camera.y_fov);
  const float aspect = static_cast<float>(frame.size.x) / static_cast<float>(frame.size.y);
  const glm::mat4& m = camera.to_world;
  const auto axis = [&](int i) { return glm::normalize(glm::vec3(m[i])); };
  return {glm::vec3(m[3]),        axis(0) * (tangent * aspect),
          axis(1) * -tangent,     -axis(2),
          glm::uvec2(frame.size), static_cast<std::uint32_t>(std::lround(std::sqrt(frame.samples)))};
}

/// Perspective without a far plane: z / w = 1 - near / w.
glm::mat4 to_clip(const CameraRays& rays, const SceneMeshes& meshes) {
  double nearest = INFINITY, farthest = 0;
  for (const SceneMeshes::Range& range : meshes.ranges) {
    if (!range.count) continue;
    const glm::vec3 out = glm::max(glm::max(range.bounds.low - rays.eye, rays.eye - range.bounds.high), glm::vec3(0));
    nearest = std::min<double>(nearest, glm::length(out));
    farthest = std::max<double>(farthest, glm::length(range.bounds.size()) + glm::length(out));
  }
  const double near = std::max(std::isfinite(nearest) ? 0.5 * nearest : 0, std::max(1e-5 * farthest, 1e-9));
  const glm::dvec3 eye = rays.eye;
  const auto row = [&](glm::vec3 v) {
    const glm::dvec3 axis = glm::dvec3(v) / double(glm::dot(v, v));
    return glm::dvec4(axis, -glm::dot(axis, eye));
  };
  const glm::dvec4 w = row(rays.forward);
  return glm::mat4(glm::transpose(glm::dmat4(row(rays.right), row(rays.down), w - glm::dvec4(0, 0, 0, near), w)));
}

gpu::Image image2d(gpu::Context& context, glm::ivec2 size, VkFormat format, const char* name) {
  gpu::ImageSpec spec;
  spec.size = {size, 1};
  spec.format = format;
  spec.type = VK_IMAGE_TYPE_2D;
  if (format == VK_FORMAT_D32_SFLOAT)
    spec.usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
  else if (format == id_format)
    spec.usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT;
  return gpu::Image(context, spec, name);
}

struct Rectangle {
  glm::uvec2 low{0}, high{0};  // pixels; high is past the last
};

/// What of the picture an object may cover: its bounds' corners projected, or all where one is behind the eye.
Rectangle covered(const Bounds& bounds, const glm::mat4& matrix, glm::uvec2 size) {
  glm::vec2 low(INFINITY), high(-INFINITY);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 pick(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
    const glm::vec4 clip = matrix * glm::vec4(glm::mix(bounds.low, bounds.high, pick), 1);
    if (clip.z <= 0) return {{0, 0}, size};
    low = glm::min(low, glm::vec2(clip) / clip.w);
    high = glm::max(high, glm::vec2(clip) / clip.w);
  }
  const auto pixel = [&](glm::vec2 p, float margin) {
    return glm::uvec2(glm::clamp((0.5f * p + 0.5f) * glm::vec2(size) + margin, glm::vec2(0), glm::vec2(size)));
  };
  return {pixel(low, -1), pixel(high, 2)};
}

/// The images that shading/visible.glsl adds up in.
struct Sums {
  Sums(gpu::Context& context, glm::ivec2 size)
      : multiple(image2d(context, size, format, "multiple")),
        single(image2d(context, size, format, "single")),
        surface(image2d(context, size, format, "surface")),
        fluence(image2d(context, size, format, "fluence")),
        gamma_s(image2d(context, size, format, "gamma_s")),
        normals(image2d(context, size, format, "normals")) {}
  static constexpr VkFormat format = VK_FORMAT_R32G32B32A32_SFLOAT;
  gpu::Image multiple, single, surface, fluence, gamma_s, normals;
};

/// Opaque and emissive objects, and the index of each triangle's object among them.
struct PlainObjects {
  std::vector<PlainObject> objects;
  std::vector<std::int32_t> of_triangle;  // -1: translucent
};

PlainObjects plain_objects(const Scene& scene) {
  PlainObjects plain;
  for (const Object& object : scene.objects) {
    const bool emissive = object.role == Role::emissive;
    const int index = object.role == Role::translucent ? -1 : static_cast<int>(plain.objects.size());
    if (index >= 0) plain.objects.push_back({emissive ? object.radiance : object.albedo, emissive, object.two_sided});
    plain.of_triangle.insert(plain.of_triangle.end(), object.mesh.triangles.size(), index);
  }
  return plain;
}

TranslucentPush translucent_push(const Shading::Input& input, const TranslucentSurface& surface,
                                 const CameraRays& rays) {
  const SceneMeshes::Range& range = input.meshes.ranges[surface.object];
  const double eta = input.scene.objects[surface.object].eta;
  const double f_dr = internal_diffuse_reflectance(eta);
  TranslucentPush push;
  push.camera = rays;
  push.first = range.first;
  push.count = range.count;
  push.grid_low = surface.frame.origin;
  push.grid_inverse = 1.0f / (surface.frame.h * glm::vec3(surface.frame.cells));
  push.eta = static_cast<float>(eta);
  push.A = static_cast<float>(boundary_constant(f_dr));
  push.f_dt = static_cast<float>(1 - f_dr);
  push.exit_scale = input.exit == Exit::as_printed ? 1.0f : static_cast<float>(1 / (eta * eta));
  return push;
}

void check_frame(const Frame& frame) {
  const int edge = static_cast<int>(std::lround(std::sqrt(std::max(frame.samples, 0))));
  if (edge * edge != frame.samples || edge < 1 || edge > 5)
    throw UserError("picture: " + std::to_string(frame.samples) + " samples a pixel; choose 1, 4, 9, 16 or 25");
  if (frame.size.x < 1 || frame.size.y < 1)
    throw UserError("picture: --size " + std::to_string(frame.size.x) + "x" + std::to_string(frame.size.y) +
                    " has no pixels; choose a positive width and height");
}

/// One of the images of sums, on the host.
class PixelSums {
 public:
  PixelSums(gpu::Context& context, const gpu::Image& image) : copy_(gpu::host_copy(context, image)) {}
  const glm::vec4& operator[](std::size_t pixel) const { return static_cast<const glm::vec4*>(copy_.mapped())[pixel]; }

 private:
  gpu::Buffer copy_;
};

/// From the pixel sums to named planes.
ShadedPicture planes(gpu::Context& context, const Sums& sums, glm::ivec2 size, bool with_single) {
  const PixelSums multiple(context, sums.multiple);
  const PixelSums single(context, sums.single);
  const PixelSums surface(context, sums.surface);
  const PixelSums fluence(context, sums.fluence);
  const PixelSums gamma_s(context, sums.gamma_s);
  const PixelSums normals(context, sums.normals);

  ShadedPicture result;
  Picture& picture = result.picture;
  picture.width = size.x;
  picture.height = size.y;
  const std::size_t n = std::size_t(size.x) * std::size_t(size.y);
  tbb::task_group tasks;
  const auto fill = [&](const std::string& name, auto value) {
    std::vector<float>& plane = picture.channels[name];  // it stays where it is when others are added
    tasks.run([&plane, n, value] {
      plane.resize(n);
      for (std::size_t i = 0; i < n; ++i) plane[i] = value(i);
    });
  };
  const auto mean = [](float sum, float share) { return share > 0 ? sum / share : 0.0f; };
  const char* const rgb[] = {"R", "G", "B"};
  const char* const xyz[] = {"N.X", "N.Y", "N.Z"};
  for (int c = 0; c < 3; ++c) {
    const std::string channel = rgb[c];
    fill(channel, [&, c](std::size_t i) { return multiple[i][c] + single[i][c] + surface[i][c]; });
    fill("multiple." + channel, [&, c](std::size_t i) { return multiple[i][c] + (with_single ? 0 : single[i][c]); });
    if (with_single) fill("single." + channel, [&, c](std::size_t i) { return single[i][c]; });
    fill("surface." + channel, [&, c](std::size_t i) { return surface[i][c]; });
    fill("fluence." + channel, [&, c](std::size_t i) { return mean(fluence[i][c], multiple[i].a); });
    fill("gamma_s." + channel, [&, c](std::size_t i) { return mean(gamma_s[i][c], multiple[i].a); });
    fill(xyz[c], [&, c](std::size_t i) { return mean(normals[i][c], glm::length(glm::vec3(normals[i]))); });
  }
  fill("Z", [&](std::size_t i) { return mean(fluence[i].a, gamma_s[i].a); });
  fill("object.Y", [&](std::size_t i) { return multiple[i].a; });

  std::size_t translucent = 0;
  for (std::size_t i = 0; i < n; ++i) {
    translucent += multiple[i].a > 0;
    result.negative_pixels += surface[i].a > 0;
  }
  tasks.wait();
  if (translucent)
    result.negative_share = static_cast<double>(result.negative_pixels) / static_cast<double>(translucent);
  return result;
}

}  // namespace

Shading::Shading(gpu::Context& context)
    : context_(context),
      linear_(context, gpu::Filter::linear),
      nearest_(context, gpu::Filter::nearest),
      visibility_(context, "shading/visibility.vert", "shading/visibility.frag", id_and_depth()),
      places_{{context, "shading/plain_places.comp", {0}}, {context, "shading/plain_places.comp", {1}}},
      plain_(context, "shading/plain.comp"),
      translucent_(context, "shading/translucent.comp"),
      reflection_(std::make_unique<Reflection>(context)) {}

Shading::~Shading() = default;

void Shading::begin(const Scene& scene, bool gather, bool straight) const {
  reflection_->begin(scene);
  if (gather) gathered();
  if (straight) reflection_->begin_straight(scene, gather);
}

const gpu::Pass& Shading::gathered() const {
  if (!gathered_) gathered_ = std::make_unique<gpu::Pass>(context_, "shading/gathered.comp");
  return *gathered_;
}

void Shading::draw_visible(const Input& input, const glm::mat4& matrix, const gpu::Targets& targets) const {
  gpu::Commands commands(context_);
  {
    const auto timer = commands.time("visibility");
    commands.begin_rendering(targets);
    for (std::size_t i = 0; i < input.meshes.ranges.size(); ++i)
      if (input.meshes.ranges[i].count)
        commands.draw(visibility_, {}, input.meshes.geometry(i), VisibilityPush{matrix, input.meshes.ranges[i].first});
    commands.end_rendering();
  }
  commands.submit();
}

void Shading::record_plain(gpu::Commands& commands, const Input& input, const CameraRays& rays,
                           const gpu::Bindings& shared) const {
  const PlainObjects plain = plain_objects(input.scene);
  const PlainPush push{rays, input.lighting.environment_turn()};
  const std::size_t pixels = std::size_t(rays.size.x) * rays.size.y;
  gpu::Bindings bindings = shared;
  bindings.push_back({"objects", commands.keep(gpu::make_buffer(context_, plain.objects, "plain objects"))});
  bindings.push_back(
      {"triangle_objects", commands.keep(gpu::make_buffer(context_, plain.of_triangle, "objects of triangles"))});
  bindings.push_back(
      {"first_places", commands.keep(gpu::Buffer(context_, pixels * sizeof(std::uint32_t), "places of pixels"))});
  gpu::Bindings writing = bindings;

  gpu::Buffer count(context_, sizeof(std::uint32_t), "plain places", gpu::Memory::host), none(context_, 0, "no places");
  writing.push_back({"count", count});
  writing.push_back({"places", none});
  gpu::Commands counting(context_);
  counting.fill(count);
  counting.dispatch(places_[0], {rays.size, 1}, writing, push);
  counting.submit();
  const std::uint32_t places = *static_cast<const std::uint32_t*>(count.mapped());

  const gpu::Buffer& receivers = commands.keep(gpu::Buffer(context_, places * sizeof(Receiver), "places"));
  const gpu::Buffer& irradiance = commands.keep(gpu::Buffer(context_, places * sizeof(glm::vec3), "irradiance"));
  writing.pop_back();
  writing.push_back({"places", receivers});
  const auto timer = commands.time("plain");
  commands.dispatch(places_[1], {rays.size, 1}, writing, push);
  input.lighting.record_gather(commands, receivers, places, 1, irradiance);
  bindings.push_back(input.lighting.environment_binding());
  bindings.push_back({"irradiance", irradiance});
  commands.dispatch(plain_, {rays.size, 1}, bindings, push);
  commands.keep(std::move(count));
}

void Shading::record_single(gpu::Commands& commands, Single single) const {
  const auto timer = commands.time("single");
  if (!single_) single_ = std::make_unique<gpu::Pass>(context_, "shading/single.comp");
  const Lighting& lighting = single.input.lighting;
  for (const gpu::Bindings& more :
       {single.surface.single->picture_bindings(), lighting.bindings(), single.input.meshes.rays.bindings()})
    single.bindings.insert(single.bindings.end(), more.begin(), more.end());
  const auto lights = static_cast<std::uint32_t>(lighting.samples().area.size() + lighting.samples().directions.size());
  SinglePush push{single.push, 0, 0};
  // Lavapipe ends an invocation after 65535 turns of its loops, all taken together: a pixel's samples share them.
  const std::uint32_t samples = single.push.camera.edge * single.push.camera.edge;
  const std::uint32_t at_once = std::max(4 * SINGLE_LIGHTS / samples, 1u);
  for (; push.first_light < lights; push.first_light += at_once) {
    push.end_light = std::min(lights, push.first_light + at_once);
    commands.dispatch(*single_, {single.extent, 1}, single.bindings, push);
  }
}

ShadedPicture Shading::shade(const Input& input) const {
  check_frame(input.frame);
  const glm::ivec2 size = input.frame.size;
  const CameraRays rays = camera_rays(input.camera, input.frame);
  const glm::mat4 matrix = to_clip(rays, input.meshes);
  const glm::ivec2 fine = size * static_cast<int>(rays.edge);
  const gpu::Image ids = image2d(context_, fine, id_format, "visible");
  const gpu::Image depth = image2d(context_, fine, VK_FORMAT_D32_SFLOAT, "depth");
  const Sums sums(context_, size);
  const gpu::Bindings shared{{"visible", ids, nearest_},
                             {"positions", input.meshes.positions},
                             {"triangles", input.meshes.triangles},
                             {"multiple", sums.multiple},
                             {"surface", sums.surface},
                             {"fluence", sums.fluence},
                             {"gamma_s", sums.gamma_s},
                             {"normals", sums.normals}};
  draw_visible(input, matrix, {fine, {{&ids}}, &depth});
  const MirroredScene mirrored = reflection_->prepare(input);

  gpu::Commands commands(context_);
  record_plain(commands, input, rays, shared);
  bool with_single = false;
  commands.clear(sums.single);
  reflection_->record_glow(commands, input, mirrored);
  for (const TranslucentSurface& surface : input.surfaces) {
    gpu::Bindings bindings = shared;
    bindings.push_back({"phi_up", *surface.fluence[0], linear_});
    bindings.push_back({"phi_down", *surface.fluence[1], linear_});
    bindings.push_back({"gamma_up", *surface.gamma_s[0], linear_});
    bindings.push_back({"gamma_down", *surface.gamma_s[1], linear_});
    const Rectangle rectangle = covered(input.meshes.ranges[surface.object].bounds, matrix, rays.size);
    if (rectangle.low.x >= rectangle.high.x || rectangle.low.y >= rectangle.high.y) continue;
    TranslucentPush push = translucent_push(input, surface, rays);
    push.corner = rectangle.low;
    const glm::uvec2 extent = rectangle.high - rectangle.low;
    if (surface.gather) push.exit_scale = 0;
    {
      const auto timer = commands.time("translucent");
      commands.dispatch(translucent_, {extent, 1}, bindings, push);
    }
    const gpu::Buffer* open = nullptr;
    if (surface.gather) {
      const auto timer = commands.time("gathered");
      open = &commands.keep(gpu::Buffer(
          context_, 4 * sizeof(std::uint32_t) * (1 + std::size_t(extent.x) * extent.y / 4 + 1), "open pixels"));
      commands.fill(*open);
      bindings = surface.gather->picture_bindings();
      for (const gpu::Binding& binding : shared) bindings.push_back(binding);
      bindings.push_back({"single", sums.single});
      bindings.push_back({"open_groups", *open});
      with_single = true;
      commands.dispatch(gathered(), {extent, 1}, bindings, push);
    }
    if (surface.single) {
      with_single = true;
      bindings = shared;
      bindings.push_back({"single", sums.single});
      record_single(commands, {input, surface, push, extent, bindings});
    }
    if (surface.straight) {
      gpu::Bindings sums_there = shared;
      sums_there.push_back({"single", sums.single});
      reflection_->record_straight(commands, input, mirrored, {surface, rays, rectangle.low, extent, sums_there}, open);
    }
    if (input.scene.objects[static_cast<std::size_t>(surface.object)].eta != 1)
      reflection_->record(commands, input, mirrored, {surface, rays, rectangle.low, extent, shared});
  }
  commands.submit();
  return planes(context_, sums, size, with_single);
}

}  // namespace alabaster

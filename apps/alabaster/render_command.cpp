#include <algorithm>
#include <chrono>
#include <cstdio>
#include <future>
#include <memory>
#include <nlohmann/json.hpp>

#include "arguments.h"
#include "commands.h"
#include "image/whole_file.h"
#include "pipeline/render.h"
#include "pipeline/report.h"
#include "scene/load.h"

namespace alabaster {
namespace {

struct Arguments {
  std::string scene, output, png, stats, device, size = "640x480", grid = "auto";
  std::string transport, quality = "balanced", curve = "srgb";
  std::vector<std::string> components;
  double exposure = 0;
  int light_samples = 0, interreflections = -1, exchange_directions = 0;
  Request request;
};

Request request_of(const Arguments& a) {
  Request request = a.request;
  request.size = parse_size(a.size);
  request.grid = parse_grid(a.grid);
  request.quality = a.quality == "preview"    ? Quality::preview
                    : a.quality == "accurate" ? Quality::accurate
                                              : Quality::balanced;
  request.transport = usual_transport(request.quality);
  if (!a.transport.empty())
    request.transport = static_cast<Transport>(
        std::find(std::begin(transport_names), std::end(transport_names), a.transport) - std::begin(transport_names));
  if (!a.components.empty()) request.components.emplace();
  for (const std::string& name : a.components)
    request.components->insert(static_cast<Component>(
        std::find(std::begin(component_names), std::end(component_names), name) - std::begin(component_names)));
  if (a.light_samples > 0) request.light_samples = a.light_samples;
  if (a.interreflections >= 0) request.interreflections = a.interreflections;
  if (a.exchange_directions > 0) request.exchange_directions = a.exchange_directions;
  return request;
}

/// Opened while the scene is being read.
struct Device {
  explicit Device(const std::string& name) {
    gpu::ContextOptions options;
    options.device = name;
    context = std::make_unique<gpu::Context>(options);
    pipelines = std::make_unique<Pipelines>(*context);
  }
  std::unique_ptr<gpu::Context> context;
  std::unique_ptr<Pipelines> pipelines;
};

void run(const Arguments& a) {
  using Clock = std::chrono::steady_clock;
  const auto milliseconds = [](Clock::time_point since) {
    return std::chrono::duration<double, std::milli>(Clock::now() - since).count();
  };
  for (const std::string& path : {a.output, a.png, a.stats})
    if (!path.empty()) check_writable(path);

  auto start = Clock::now();
  std::future<Device> opening = std::async(std::launch::async, [&] { return Device(a.device); });
  const Scene scene = load_scene(a.scene);
  print_warnings(scene);
  const double load_ms = milliseconds(start);

  start = Clock::now();
  const Device device = opening.get();
  gpu::Context& context = *device.context;
  const double device_ms = milliseconds(start);

  const Plan plan = make_plan(scene, request_of(a), context.info().heap_bytes);
  RenderResult result = render_scene(context, *device.pipelines, scene, plan);
  result.stages["load"] = load_ms;
  result.stages["device"] = device_ms;
  for (const std::string& warning : result.warnings) std::fprintf(stderr, "warning: %s\n", warning.c_str());
  if (result.shaded.negative_pixels > 0)
    std::fprintf(stderr,
                 "warning: the query was negative and set to 0 at %zu pixels (%.2f %% of the object's): the medium "
                 "absorbs too much there for diffusion\n",
                 result.shaded.negative_pixels, 100 * result.shaded.negative_share);

  start = Clock::now();
  describe(result, plan, context, result.shaded.picture);
  write_exr(result.shaded.picture, a.output, true);
  if (!a.png.empty())
    write_png(result.shaded.picture, a.png, a.exposure, a.curve == "filmic" ? Curve::filmic : Curve::srgb);
  result.stages["write"] = milliseconds(start);
  if (!a.stats.empty()) write_whole_file(a.stats, stats_json(result, plan, context).dump(2) + "\n");
}

}  // namespace

void add_render(CLI::App& app) {
  auto* command = app.add_subcommand("render", "picture of a scene by diffusion");
  auto a = std::make_shared<Arguments>();
  command->add_option("scene", a->scene, "glTF 2.0 scene (.glb, .gltf)")->required();
  command->add_option("-o,--output", a->output, "picture with layers (EXR)")->required();
  command->add_option("--png", a->png, "picture to look at (PNG)");
  command->add_option("--exposure", a->exposure, "of the PNG, stops")->check(CLI::Range(-64.0, 64.0));
  command->add_option("--curve", a->curve, "of the PNG")
      ->check(CLI::IsMember({"srgb", "filmic"}))
      ->capture_default_str();
  command->add_option("--stats", a->stats, "what was done, how long it took, how well it closed (JSON)");
  command->add_option("--size", a->size, "WIDTHxHEIGHT, pixels")->capture_default_str();
  command->add_option("--camera", a->request.camera, "its name (default: the first)");
  command->add_option("--grid", a->grid, "cells along the longest side of each object, or auto")->capture_default_str();
  command->add_option("--tolerance", a->request.tolerance, "relative residual of the solver")->capture_default_str();
  command
      ->add_option(
          "--transport", a->transport,
          "how light enters and leaves (default: gather, nearest to the path tracer; report with --quality preview)")
      ->check(CLI::IsMember(std::vector<std::string>(std::begin(transport_names), std::end(transport_names))))
      ->capture_default_str();
  command
      ->add_option("--components", a->components,
                   "multiple,single,surface; without single, multiple carries it (default: by transport)")
      ->delimiter(',')
      ->check(CLI::IsMember(std::vector<std::string>(std::begin(component_names), std::end(component_names))));
  command->add_option("--quality", a->quality, "preview, balanced, accurate")
      ->check(CLI::IsMember({"preview", "balanced", "accurate"}))
      ->capture_default_str();
  command->add_option("--light-samples", a->light_samples, "points on area lights (default: by quality)")
      ->check(CLI::Range(1, 1024));
  command
      ->add_option("--interreflections", a->interreflections,
                   "passes at most of light between surfaces, 0 for none (default: by quality)")
      ->check(CLI::Range(0, 100));
  command
      ->add_option("--exchange-directions", a->exchange_directions,
                   "in which each facet looks for other surfaces (default: by quality)")
      ->check(CLI::Range(4, 1024));
  command->add_option("--device", a->device, "part of a Vulkan device's name (default: the best)");
  command->callback([a] { run(*a); });
}

}  // namespace alabaster

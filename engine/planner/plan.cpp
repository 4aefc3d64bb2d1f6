#include "planner/plan.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "domain/grid_frame.h"
#include "scene/convex.h"
#include "scene/error.h"
#include "scene/inside.h"
#include "scene/shapes.h"

namespace alabaster {
namespace {

constexpr int most_pixels_of_a_small_picture = 320 * 240;

const Camera& find_camera(const Scene& scene, const std::string& name) {
  if (name.empty()) return scene.cameras.front();
  std::string known;
  for (const Camera& camera : scene.cameras) {
    if (camera.name == name) return camera;
    known += (known.empty() ? "" : ", ") + camera.name;
  }
  throw UserError(scene.path + ": --camera " + name + ": there is no such camera; it has: " + known);
}

bool is_grey(glm::dvec3 c) { return c.r == c.g && c.g == c.b; }

/// One solve serves all three channels where neither a material nor a light has colour.
bool is_grey(const Scene& scene) {
  for (const Object& object : scene.objects) {
    if (object.role == Role::opaque && !is_grey(object.albedo)) return false;  // it lights the translucent ones
    if (object.role == Role::emissive && !is_grey(object.radiance)) return false;
    if (object.role != Role::translucent) continue;
    if (!object.medium.grey()) return false;
  }
  for (const PunctualLight& light : scene.lights)
    if (!is_grey(light.intensity)) return false;
  return scene.environment.grey();
}

int preferred_grid(Quality quality) {
  switch (quality) {
    case Quality::preview:
      return 32;
    case Quality::balanced:
      return 64;
    case Quality::accurate:
      return 128;
  }
  return 64;
}

int choose_grid(const Scene& scene, const Request& request, Plan& plan, std::uint64_t heap_bytes) {
  const auto fits = [&](int grid) { return bytes_needed(scene, plan, grid) <= heap_bytes / 10 * 8; };
  int grid = request.grid.value_or(preferred_grid(request.quality));
  if (grid < smallest_grid || grid > largest_grid || !fits(grid)) {
    int most = std::clamp(grid, smallest_grid, largest_grid);
    while (most > smallest_grid && !fits(most)) most -= 4;
    if (request.grid)
      throw UserError(
          "--grid " + std::to_string(grid) + ": choose " + std::to_string(smallest_grid) + " to " +
          std::to_string(std::max(most, smallest_grid)) +
          " cells along the longest side of an object; more does not fit this device's memory or the solver");
    plan.reasons.push_back("grid " + std::to_string(grid) + " lowered to " + std::to_string(most) +
                           ": the device's memory");
    grid = most;
  }
  if (!request.grid)
    plan.reasons.push_back("grid " + std::to_string(grid) + ": the quality asked for; --grid sets another");
  return grid;
}

/// Why there is no light between surfaces to follow; empty where there is.
std::string without_exchange(const Scene& scene, Transport transport) {
  if (transport == Transport::as_printed) return "the report as printed has none";
  const Object* alone = nullptr;
  for (const Object& object : scene.objects) {
    if (object.role == Role::emissive || (object.role == Role::opaque && object.albedo == glm::vec3(0))) continue;
    if (object.role == Role::opaque || alone) return "";
    alone = &object;
  }
  return alone && is_convex(alone->mesh) ? "the one object is convex" : "";
}

void plan_interreflections(const Scene& scene, const Request& request, Plan& plan) {
  if (request.interreflections.value_or(0) < 0 || request.interreflections.value_or(0) > 100)
    throw UserError("--interreflections " + std::to_string(*request.interreflections) + ": choose 0 to 100 passes");
  const bool preview = request.quality == Quality::preview;
  plan.exchange_directions = request.exchange_directions.value_or(preview                                ? 16
                                                                  : request.quality == Quality::accurate ? 64
                                                                                                         : 24);
  plan.interreflections = request.interreflections.value_or(preview ? 2 : 12);
  const std::string none = without_exchange(scene, request.transport);
  if (!none.empty()) plan.interreflections = 0;
  plan.reasons.push_back(!none.empty() ? "no light between surfaces: " + none
                         : plan.interreflections == 0
                             ? "no light between surfaces: --interreflections 0"
                             : "light between surfaces: at most " + std::to_string(plan.interreflections) +
                                   " passes, " + std::to_string(plan.exchange_directions) +
                                   " directions a facet; --interreflections and --exchange-directions set others");
}

/// Single scattering by itself is free in a gather; elsewhere it takes rays to every light, and only who asks pays.
void plan_components(const Request& request, Plan& plan) {
  const bool gather = request.transport == Transport::gather;
  plan.components = {Component::multiple, Component::surface};
  if (gather) plan.components.insert(Component::single);
  plan.components = request.components.value_or(plan.components);
  if (request.transport == Transport::as_printed) plan.components.erase(Component::single);
  const bool apart = plan.components.count(Component::single) > 0;
  plan.reasons.push_back(apart && gather ? "single scattering by itself: the gather has it apart"
                         : apart         ? "single scattering by itself: --components has it"
                         : gather        ? "single scattering in `multiple`: --components leaves it there"
                         : request.transport == Transport::as_printed
                             ? "single scattering in `multiple`: the query as printed is left as it is"
                             : "single scattering in `multiple`, whose query carries it: --components "
                               "multiple,single,surface draws it by itself, by rays to every light");
}

}  // namespace

const char* name_of(Transport transport) { return transport_names[static_cast<int>(transport)]; }
const char* name_of(Component component) { return component_names[static_cast<int>(component)]; }

// Measured as the peak of a render (device.peak_bytes of --stats), of objects whose grids have up to 10^6 cells: it is
// 3 to 20 % below this.
std::uint64_t bytes_needed(const Scene& scene, const Plan& plan, int grid) {
  const bool beams = plan.transport == Transport::beam || plan.transport == Transport::gather;
  const double per_cell = 90 + (plan.transport == Transport::gather ? 32 : 0) + (beams ? 177 : 125) * plan.channels;
  const double per_facet = 1000 + (beams ? 500 : 0) + (plan.interreflections > 0 ? 50 * plan.exchange_directions : 0);
  const double maps = plan.light_samples + plan.environment_samples + 6.0 * static_cast<double>(scene.lights.size());
  double bytes = 4e6 + 4.0 * maps * plan.shadow_map_size * plan.shadow_map_size;
  for (const Object& object : scene.objects) {
    if (object.role != Role::translucent) continue;
    const GridFrame frame = choose_frame(bounds_of(object.mesh), grid);
    const double facets =
        1.5 * area(object.mesh) / (double(frame.h) * frame.h);  // 1.5: the mean of |n_x| + |n_y| + |n_z|
    bytes += per_cell * frame.cells.x * frame.cells.y * frame.cells.z + per_facet * facets;
  }
  return static_cast<std::uint64_t>(bytes);
}

Plan make_plan(const Scene& scene, const Request& request, std::uint64_t heap_bytes) {
  Plan plan;
  plan.size = request.size;
  plan.camera = find_camera(scene, request.camera);
  plan.transport = request.transport;
  plan.tolerance = request.tolerance;
  if (!(plan.tolerance > 0 && plan.tolerance < 1))
    throw UserError("--tolerance must lie between 0 and 1; 1e-6 is usual");
  for (const Object& object : scene.objects)
    if (object.role == Role::translucent && inside(object.mesh, glm::vec3(plan.camera.to_world[3])))
      throw UserError(scene.path + ": camera " + plan.camera.name + " is inside the translucent object " + object.name +
                      "; move it outside");

  plan.channels = is_grey(scene) ? 1 : 3;
  plan.reasons.push_back(plan.channels == 1 ? "one channel: materials and lights are grey"
                                            : "three channels: a material or a light has colour");
  const int usual = request.quality == Quality::preview ? 8 : request.quality == Quality::accurate ? 128 : 32;
  plan.light_samples = request.light_samples.value_or(usual);
  // An edge takes up the more of a picture the smaller that is, and 4 samples misjudge what an edge's pixel holds by 10
  // %.
  const bool small = plan.size.x * plan.size.y <= most_pixels_of_a_small_picture;
  plan.pixel_samples = small && request.quality != Quality::preview ? 16 : 4;
  if (plan.pixel_samples > 4)
    plan.reasons.push_back("16 samples a pixel: the picture is small, and its edges a part of it");
  plan_interreflections(scene, request, plan);
  plan_components(request, plan);
  const bool opaque = std::any_of(scene.objects.begin(), scene.objects.end(),
                                  [](const Object& object) { return object.role == Role::opaque; });
  // The directions of light between surfaces see to the environment, too.
  const bool looked_up = plan.interreflections == 0 || opaque || plan.components.count(Component::single) > 0;
  const bool by_maps = scene.environment.picture || looked_up;
  plan.environment_samples = scene.environment.dark() || !by_maps ? 0 : 2 * usual;
  plan.grid = choose_grid(scene, request, plan, heap_bytes);
  plan.reasons.push_back(
      "surface reflection: by rays to lights, objects and the environment, followed through two mirrorings");
  return plan;
}

}  // namespace alabaster

#include <cstdio>
#include <memory>

#include "commands.h"
#include "planner/plan.h"
#include "scene/load.h"
#include "scene/procedural.h"

namespace alabaster {
namespace {

void print_variation(const Medium& m) {
  if (m.solid) {
    std::printf("procedural %s, ", solid_names[m.solid->kind]);
    return;
  }
  const Grid& grid = m.sigma_t ? *m.sigma_t : *m.sigma_s;
  std::printf("grid %d x %d x %d%s, ", grid.size.x, grid.size.y, grid.size.z, grid.trilinear ? "" : " (nearest)");
}

void print_light(const PunctualLight& light) {
  const bool far = light.kind == PunctualLight::Kind::directional;
  std::printf("light %s: %s, %.4g %.4g %.4g %s, ", light.name.c_str(),
              far                                        ? "directional"
              : light.kind == PunctualLight::Kind::point ? "point"
                                                         : "spot",
              light.intensity.r, light.intensity.g, light.intensity.b, far ? "W/m^2" : "W/sr");
  if (far)
    std::printf("a disc of %.3g degrees in the sky\n", 2 * light.radius * 180 / 3.14159265358979);
  else
    std::printf("a sphere of radius %.3g mm\n", 1e3 * light.radius);
}

void print_medium(const Object& object) {
  const Medium& m = object.medium;
  const glm::dvec3 sigma_s = m.homogeneous.sigma_s, sigma_a = m.homogeneous.sigma_a;
  const double extent = glm::length(glm::dvec3(bounds_of(object.mesh).size())) / std::sqrt(3.0);
  std::printf("    eta %.3g, g %.3g, ", object.eta, m.g);
  if (m.heterogeneous()) {
    const glm::dvec3 most = m.majorant();
    print_variation(m);
    std::printf("sigma_t at most %.4g %.4g %.4g 1/m, features of %.3g mm\n", most.r, most.g, most.b,
                1e3 * m.feature_size());
    return;
  }
  std::printf("sigma_s %.4g %.4g %.4g, sigma_a %.4g %.4g %.4g 1/m\n", sigma_s.r, sigma_s.g, sigma_s.b, sigma_a.r,
              sigma_a.g, sigma_a.b);
  const glm::dvec3 reduced = sigma_s * (1 - m.g) + sigma_a;
  for (int c = 0; c < 3; ++c) {
    if (reduced[c] <= 0) {
      std::printf("    %c: empty (neither scatters nor absorbs)\n", "RGB"[c]);
      continue;
    }
    const double albedo = sigma_s[c] * (1 - m.g) / reduced[c];
    std::printf("    %c: reduced mean free path %.4g mm, %.4g of them across, reduced albedo %.5f, ", "RGB"[c],
                1e3 / reduced[c], extent * reduced[c], albedo);
    if (sigma_a[c] > 0)
      std::printf("diffusion length %.4g mm%s\n", 1e3 / std::sqrt(3 * reduced[c] * sigma_a[c]),
                  sigma_a[c] > 0.75 * reduced[c] ? "; absorbs too much for diffusion" : "");
    else
      std::printf("no absorption\n");
  }
}

const char* role_name(Role role) {
  return role == Role::translucent ? "translucent" : role == Role::opaque ? "opaque" : "emissive";
}

void run(const std::string& path) {
  const Scene scene = load_scene(path);
  for (const Object& object : scene.objects) {
    const glm::dvec3 size = 1e3 * glm::dvec3(bounds_of(object.mesh).size());
    std::printf("%s: %s, %zu triangles, %.4g x %.4g x %.4g mm\n", object.name.c_str(), role_name(object.role),
                object.mesh.triangles.size(), size.x, size.y, size.z);
    if (object.role == Role::translucent) {
      std::printf("    watertight\n");  // load_scene() repairs or refuses others, and says so in its warnings
      print_medium(object);
    }
    if (object.role == Role::emissive)
      std::printf("    radiance %.4g %.4g %.4g W/m^2/sr\n", object.radiance.r, object.radiance.g, object.radiance.b);
  }
  for (const PunctualLight& light : scene.lights) print_light(light);
  for (const Camera& camera : scene.cameras) std::printf("camera %s\n", camera.name.c_str());
  if (scene.environment.picture)
    std::printf("environment: a picture, %.4g W/m^2/sr in the mean over all directions\n",
                scene.environment.picture->total() / (4 * M_PI));
  else if (!scene.environment.dark())
    std::printf("environment: radiance %.4g %.4g %.4g W/m^2/sr from every direction\n", scene.environment.radiance.r,
                scene.environment.radiance.g, scene.environment.radiance.b);
  Request usual;
  usual.transport = usual_transport(usual.quality);
  const Plan plan = make_plan(scene, usual, UINT64_MAX / 16);
  std::printf("render would use grid %d, %d light samples, %d environment directions:\n", plan.grid, plan.light_samples,
              plan.environment_samples);
  for (const std::string& reason : plan.reasons) std::printf("    %s\n", reason.c_str());
  for (const std::string& warning : scene.warnings) std::printf("warning: %s\n", warning.c_str());
}

}  // namespace

void add_inspect(CLI::App& app) {
  auto* command = app.add_subcommand("inspect", "what is in a scene, and what would be modelled");
  auto path = std::make_shared<std::string>();
  command->add_option("scene", *path, "glTF 2.0 scene (.glb, .gltf)")->required();
  command->callback([path] { run(*path); });
}

}  // namespace alabaster

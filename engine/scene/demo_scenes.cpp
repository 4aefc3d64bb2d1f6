#include "scene/demo_scenes.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>

#include "scene/depth.h"
#include "scene/error.h"
#include "scene/marble.h"
#include "scene/material.h"
#include "scene/mesh_check.h"
#include "scene/off.h"
#include "scene/presets.h"
#include "scene/procedural.h"
#include "scene/shapes.h"

namespace alabaster {
namespace {

constexpr double height = 0.1;  // m
const glm::dvec3 study_albedo(0.999, 0.99, 0.95);
constexpr float gap = 2e-4f;  // m below the object, lest two surfaces lie in one plane

enum class Light { front, back, furnace, punctual };

struct Recipe {
  std::string name, mesh;
  Light light;
  double eta;
  std::function<Medium(const Bounds&)> medium;
};

std::function<Medium(const Bounds&)> homogeneous(glm::dvec3 sigma_s, glm::dvec3 sigma_a) {
  return [=](const Bounds&) {
    Medium medium;
    medium.homogeneous = {sigma_s, sigma_a};
    return medium;
  };
}

std::function<Medium(const Bounds&)> measured(const std::string& name) {
  Coefficients found = preset(name)->coefficients;
  return homogeneous(found.sigma_s, found.sigma_a);
}

std::function<Medium(const Bounds&)> procedural(std::uint32_t kind) {
  return [=](const Bounds& bounds) {
    Medium medium;
    medium.solid = std::make_shared<ProceduralSolid>(usual_solid(kind));
    medium.world_to_box = place_pattern({}, bounds, kind);
    return medium;
  };
}

/// Of the studies of transports: one coefficient of extinction, 1/m, or its contrasts; reduced albedos of 0.95 and
/// more.
std::function<Medium(const Bounds&)> study_medium(const std::string& material, double sigma_t) {
  const auto part = [sigma_t](double share, glm::dvec3 albedo) {
    return SolidPart{sigma_t * share * albedo, sigma_t * share * (1.0 - albedo)};
  };
  if (material == "homogeneous") return homogeneous(sigma_t * study_albedo, sigma_t * (1.0 - study_albedo));
  const std::uint32_t kind = material == "marble" ? solid_marble : solid_checker;
  return [=](const Bounds& bounds) {
    Medium medium = procedural(kind)(bounds);
    ProceduralSolid solid = *medium.solid;
    solid.parts[0] = solid.parts[2] = part(1, glm::dvec3(0.999));
    solid.parts[1] = part(kind == solid_marble ? 0.6 : 0.25, {0.99, 0.97, 0.95});
    medium.solid = std::make_shared<ProceduralSolid>(solid);
    return medium;
  };
}

std::vector<Recipe> recipes() {
  auto marble = [](const Bounds& bounds) { return veined_marble(bounds, 64); };
  auto white = homogeneous(glm::dvec3(500), glm::dvec3(0));  // 50 mean free paths, nothing absorbed
  auto wax = homogeneous({1100, 950, 700}, {1.5, 6, 22});
  auto jade = homogeneous({380, 520, 420}, {9, 1.2, 6});
  auto leaf = homogeneous(glm::dvec3(1990), {16, 4, 40});  // 4 mean free paths through the plate
  return {{"bunny-marble", "bunny", Light::front, 1.5, marble},
          {"bunny-homogeneous", "bunny", Light::front, 1.5, measured("marble")},
          {"bunny-milk", "bunny", Light::front, 1.3, measured("skimmilk")},
          {"armadillo-wax", "armadillo", Light::front, 1.4, wax},
          {"dragon-jade", "dragon", Light::back, 1.5, jade},
          {"elephant-marble", "elephant", Light::front, 1.5, marble},
          {"hand-skin", "hand", Light::front, 1.3, measured("skin2")},
          {"sphere-marble", "sphere", Light::front, 1.5, marble},
          {"torus-wax", "torus", Light::front, 1.4, wax},
          {"box-potato", "box", Light::front, 1.3, measured("potato")},
          {"torus-lights", "torus", Light::punctual, 1.4, wax},
          {"bunny-jade", "bunny", Light::front, 1.5, procedural(solid_jade)},
          {"bunny-agate", "bunny", Light::front, 1.5, procedural(solid_agate)},
          {"sphere-wood", "sphere", Light::front, 1.4, procedural(solid_wood)},
          {"torus-checker", "torus", Light::front, 1.3, procedural(solid_checker)},
          {"hand-layers", "hand", Light::front, 1.4, procedural(solid_skin)},
          {"plate-leaf", "plate", Light::back, 1.3, leaf},
          {"sphere-furnace", "sphere", Light::furnace, 1.3, white},
          {"box-furnace", "box", Light::furnace, 1.3, white},
          {"torus-furnace", "torus", Light::furnace, 1.3, white},
          {"bunny-furnace", "bunny", Light::furnace, 1.3, white}};
}

/// A scanned mesh as it should stand, y up and looking to +z or aside. The files' own axes were found by looking.
Mesh scanned(const std::string& file, const std::string& folder, const glm::dmat4& turn) {
  std::string path = (std::filesystem::path(folder) / file).string();
  if (!std::filesystem::exists(path))
    throw UserError(path + ": there is no such mesh; run third_party/fetch-meshes, or give its folder with --meshes");
  return transformed(read_off(path), turn);
}

Mesh shape(const std::string& name, const std::string& folder) {
  const glm::dmat4 as_is(1);
  if (name == "sphere") return icosphere(5);
  if (name == "torus") return transformed(torus(1, 0.4f, 128, 64), rotation({1, 0, 0}, 60));
  if (name == "box") return transformed(box(glm::vec3(1), 8), rotation({0, 1, 0}, 30));
  if (name == "plate") return transformed(box({0.8f, 1, 0.02f}, 16), rotation({0, 1, 0}, 20));
  if (name == "bunny") return scanned("bunny00.off", folder, as_is);
  if (name == "armadillo") return scanned("armadillo.off", folder, rotation({0, 1, 0}, 180));
  if (name == "dragon") return scanned("ChineseDragon-10kv.off", folder, as_is);
  if (name == "elephant") return scanned("refined_elephant.off", folder, as_is);
  if (name == "hand") return scanned("hand.off", folder, rotation({1, 0, 0}, -90));  // a fist, up from the wrist
  throw UserError("mesh '" + name +
                  "' is not known; use sphere, torus, box, plate, bunny, armadillo, dragon, elephant or hand");
}

/// Scaled to `height`, standing on y = 0 in the middle.
Mesh placed(const Mesh& mesh) {
  Bounds bounds = bounds_of(mesh);
  glm::dvec3 foot(bounds.centre().x, bounds.low.y, bounds.centre().z);
  return transformed(mesh, scaling(glm::dvec3(height / bounds.size().y)) * translation(-foot));
}

/// A square lamp that faces the middle of the object.
Object lamp(const std::string& name, glm::dvec3 position, float edge, glm::vec3 radiance) {
  Object result;
  result.name = name;
  result.role = Role::emissive;
  glm::dmat4 frame(look_at(position, {0, 0.5 * height, 0}));  // quads face +y, frames look along -z
  result.mesh = transformed(quad(edge, edge), frame * rotation({1, 0, 0}, -90));
  result.radiance = radiance;
  return result;
}

void light(Scene& scene, Light kind) {
  if (kind == Light::furnace) {
    scene.environment.radiance = glm::vec3(1);
    return;
  }
  if (kind == Light::punctual) {
    using Kind = PunctualLight::Kind;
    const double usual = 0.02;
    scene.lights = {{"bulb", Kind::point, {0.4f, 0.32f, 0.2f}, {-0.22f, 0.3f, 0.26f}, {0, 0, -1}, 0, 0.7, 0.008},
                    {"torch", Kind::spot, {0.2f, 0.3f, 0.5f}, {0.3f, 0.25f, 0.1f}, {0, 0, -1}, 0.1, 0.25, 0.007},
                    {"sun", Kind::directional, {0.8f, 0.8f, 0.8f}, {0, 0, 0}, {0, 0, -1}, 0, 0.7, usual}};
    scene.lights[1].direction = glm::normalize(glm::vec3(0, 0.05f, 0) - scene.lights[1].position);
    scene.lights[2].direction = glm::normalize(glm::vec3(0.2f, -1, 0.5f));
  } else if (kind == Light::back) {
    scene.objects.push_back(lamp("back", {0.12, 0.22, -0.3}, 0.24f, {22, 21, 20}));
    scene.objects.push_back(lamp("key", {-0.25, 0.3, 0.3}, 0.24f, {2.5f, 2.5f, 2.75f}));
  } else {
    scene.objects.push_back(lamp("key", {-0.22, 0.3, 0.26}, 0.24f, {16, 15, 13.5f}));
    scene.objects.push_back(lamp("fill", {0.35, 0.2, 0.15}, 0.3f, {1.5f, 1.75f, 2.25f}));
  }
}

/// Dark, because the renderer does not model the light that opaque surfaces send back to the object.
Object ground() {
  Object result;
  result.name = "ground";
  result.mesh = transformed(quad(6, 6), translation({0, -gap, 0}));
  result.albedo = glm::vec3(0.06f);
  return result;
}

/// Three quarters from the front and a little above, the bounding sphere filling the height.
Camera framing(const Bounds& bounds) {
  const float y_fov = 0.5f;
  float radius = 0.5f * glm::length(bounds.size());
  glm::vec3 direction = glm::normalize(glm::vec3(0.45f, 0.42f, 1));
  glm::vec3 target = bounds.centre();
  return {"main", look_at(target + direction * (0.95f * radius / std::sin(0.5f * y_fov)), target), y_fov};
}

Scene made(const Recipe& recipe, const std::string& folder) {
  Scene scene;
  Object object;
  object.name = recipe.mesh;
  object.role = Role::translucent;
  object.mesh = checked_solid(placed(shape(recipe.mesh, folder)), recipe.mesh, recipe.name, scene.warnings);
  object.eta = recipe.eta;
  Bounds bounds = bounds_of(object.mesh);
  object.medium = recipe.medium(bounds);
  add_depth(object);
  scene.objects.push_back(std::move(object));
  scene.cameras.push_back(framing(bounds));
  light(scene, recipe.light);
  return scene;
}

bool all_read(const std::string& text, int used) { return std::size_t(used) == text.size(); }

/// "-front", "-back" or "-punctual" at a study's end; without, the dragon and the thin plate are lit from behind.
std::optional<Light> study_light(const std::string& suffix, const std::string& mesh) {
  if (suffix.empty()) return mesh == "dragon" || mesh == "plate" ? Light::back : Light::front;
  if (suffix == "-front") return Light::front;
  if (suffix == "-back") return Light::back;
  if (suffix == "-punctual") return Light::punctual;
  return std::nullopt;
}

/// Studies compare the object alone: no ground.
std::optional<Recipe> study_recipe(const std::string& name) {
  char mesh[32], material[32];
  double paths, albedo, eta;
  int used = 0;
  const auto sane = [&] { return paths > 0 && eta > 0 && std::isfinite(paths + eta); };
  if (std::sscanf(name.c_str(), "%31[a-z]-%lfmfp-%lf-%lf%n", mesh, &paths, &albedo, &eta, &used) == 4 &&
      all_read(name, used) && sane() && albedo >= 0 && albedo <= 1) {
    const double sigma_t = paths / height;
    return Recipe{name, mesh, Light::front, eta,
                  homogeneous(glm::dvec3(sigma_t * albedo), glm::dvec3(sigma_t * (1 - albedo)))};
  }
  if (std::sscanf(name.c_str(), "%31[a-z]-%31[a-z]-%lfmfp-%lf%n", mesh, material, &paths, &eta, &used) == 4 && sane()) {
    const std::string made_of = material;
    const std::optional<Light> light = study_light(name.substr(std::size_t(used)), mesh);
    if (light && (made_of == "homogeneous" || made_of == "marble" || made_of == "checker"))
      return Recipe{name, mesh, *light, eta, study_medium(made_of, paths / height)};
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::string> demo_scene_names() {
  std::vector<std::string> names;
  for (const Recipe& recipe : recipes()) names.push_back(recipe.name);
  return names;
}

Scene demo_scene(const std::string& name, const std::string& mesh_folder) {
  for (const Recipe& recipe : recipes())
    if (recipe.name == name) {
      Scene scene = made(recipe, mesh_folder);
      if (recipe.light != Light::furnace) scene.objects.push_back(ground());
      return scene;
    }
  if (const std::optional<Recipe> study = study_recipe(name)) return made(*study, mesh_folder);
  std::string known;
  for (const std::string& other : demo_scene_names()) known += other + ", ";
  throw UserError(
      "scene '" + name + "' is not known; use " + known +
      "MESH-Nmfp-ALBEDO-ETA or MESH-MATERIAL-Nmfp-ETA (homogeneous, marble, checker), and -front, -back or -punctual");
}

bool lit_from_behind(const std::string& name) {
  for (const Recipe& recipe : recipes())
    if (recipe.name == name) return recipe.light == Light::back;
  const std::optional<Recipe> study = study_recipe(name);
  return study && study->light == Light::back;
}

}  // namespace alabaster

#include "scene/material.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>

#include "scene/error.h"
#include "scene/presets.h"
#include "scene/procedural.h"
#include "scene/shapes.h"
#include "scene/vdb.h"
#include "scene/vol.h"

namespace alabaster {
namespace {

bool all(glm::dvec3 v, const std::function<bool(double)>& test) { return test(v.x) && test(v.y) && test(v.z); }

glm::dvec3 non_negative(const Fields& from, const std::string& key) {
  glm::dvec3 value = from.rgb(key);
  if (!all(value, [](double v) { return v >= 0; })) from.fail(key, "must not be negative");
  return value;
}

glm::dvec3 unit_range(const Fields& from, const std::string& key, glm::dvec3 fallback) {
  glm::dvec3 value = from.rgb_or(key, fallback);
  if (!all(value, [](double v) { return v >= 0 && v <= 1; })) from.fail(key, "must lie in 0..1");
  return value;
}

double anisotropy(const Fields& from, const std::string& key) {
  double g = from.number_or(key, 0);
  if (g <= -1 || g >= 1) from.fail(key, "must lie between -1 and 1, both excluded");
  return g;
}

/// Single-scattering albedo of a half space that looks as bright as `colour`: the glTF draft's inversion.
double single_scattering_albedo(double colour, double g) {
  double s = 4.09712 + 4.20863 * colour - std::sqrt(9.59217 + 41.6808 * colour + 17.7126 * colour * colour);
  return std::clamp((1 - s * s) / (1 - g * s * s), 0.0, 1.0);
}

Medium khr_medium(const Fields& scatter, const Fields& volume) {
  Medium medium;
  medium.g = anisotropy(scatter, "scatterAnisotropy");
  glm::dvec3 colour = unit_range(scatter, "multiscatterColor", glm::dvec3(0));
  glm::dvec3 attenuation = unit_range(volume, "attenuationColor", glm::dvec3(1));
  double distance = volume.number("attenuationDistance");
  if (distance <= 0) volume.fail("attenuationDistance", "must be positive (metres)");
  for (int c = 0; c < 3; ++c) {
    if (attenuation[c] <= 0) volume.fail("attenuationColor", "must be above 0 in every channel");
    double sigma_t = -std::log(attenuation[c]) / distance;
    double alpha = single_scattering_albedo(colour[c], medium.g);
    medium.homogeneous.sigma_s[c] = alpha * sigma_t;
    medium.homogeneous.sigma_a[c] = (1 - alpha) * sigma_t;
  }
  return medium;
}

/// A field of a grid medium: {"vol": "file.vol"}, or numbers that hold everywhere. Values are checked against
/// `largest`.
std::shared_ptr<const Grid> read_grid(const Fields& medium, const std::string& key, double largest, GridCache& grids) {
  std::shared_ptr<const Grid> grid;
  if (medium.is_object(key)) {
    Fields field = medium.child(key);
    std::string path = (std::filesystem::path(medium.file()).parent_path() / field.text("vol")).string();
    std::shared_ptr<const Grid>& entry = grids[path];
    try {
      if (!entry) entry = std::make_shared<Grid>(read_vol(path));
    } catch (const UserError& error) {
      field.fail("vol", std::string("cannot be used: ") + error.what());
    }
    grid = entry;
  } else {
    glm::vec3 value(medium.rgb(key));
    grid = std::make_shared<Grid>(Grid{glm::ivec3(1), 3, {value.x, value.y, value.z}});
  }
  auto [least, most] = std::minmax_element(grid->values.begin(), grid->values.end());
  if (*least < 0) medium.fail(key, "holds negative values (" + std::to_string(*least) + "); none may be below 0");
  if (*most > largest) medium.fail(key, "holds values above 1 (" + std::to_string(*most) + "); an albedo lies in 0..1");
  return grid;
}

Medium grid_medium(const Fields& from, GridCache& grids) {
  Medium medium;
  medium.g = anisotropy(from, "g");
  const bool trilinear = from.trilinear();
  auto filtered = [&](std::shared_ptr<const Grid> grid) {
    if (grid->trilinear == trilinear) return grid;
    Grid copy = *grid;
    copy.trilinear = trilinear;
    return std::shared_ptr<const Grid>(std::make_shared<Grid>(std::move(copy)));
  };
  medium.world_to_box = from.box();
  if (from.has("sigma_s")) {
    medium.sigma_s = filtered(read_grid(from, "sigma_s", INFINITY, grids));
    medium.sigma_a = filtered(read_grid(from, "sigma_a", INFINITY, grids));
    medium.scale = from.number_or("scale", 1);
    if (medium.scale <= 0) from.fail("scale", "must be positive");
    return medium;
  }
  medium.sigma_t = filtered(read_grid(from, "sigma_t", INFINITY, grids));
  medium.albedo = filtered(read_grid(from, "albedo", 1, grids));
  if (from.is_object("sigma_t")) {
    Fields sigma_t = from.child("sigma_t");
    medium.scale = sigma_t.number_or("scale", 1);
    if (medium.scale <= 0) sigma_t.fail("scale", "must be positive");
  }
  return medium;
}

/// The pattern's frame is the object's; where the scene does not place it, place_pattern() does.
Medium procedural_medium(const Fields& from, Material& out) {
  Medium medium;
  medium.g = anisotropy(from, "g");
  medium.solid = std::make_shared<ProceduralSolid>(read_procedural(from));
  if (from.has("origin")) out.pattern.origin = from.point("origin");
  if (from.has("size")) {
    out.pattern.size = from.number("size");
    if (*out.pattern.size <= 0) from.fail("size", "must be positive");
  }
  return medium;
}

void read_extras_medium(const Fields& from, GridCache& grids, Material& out) {
  std::string type = from.text("type");
  if (type == "homogeneous") {
    out.medium.homogeneous = {non_negative(from, "sigma_s"), non_negative(from, "sigma_a")};
    out.medium.g = anisotropy(from, "g");
  } else if (type == "grid") {
    out.medium = grid_medium(from, grids);
  } else if (type == "vdb") {
    out.medium = read_vdb_medium(from);
    out.medium.g = anisotropy(from, "g");
  } else if (type == "procedural") {
    out.medium = procedural_medium(from, out);
  } else if (type == "preset") {
    std::string name = from.text("name");
    std::optional<Preset> found = preset(name);
    if (!found) from.fail("name", "\"" + name + "\" is not a known preset; use one of: " + preset_names());
    out.medium.homogeneous = found->coefficients;
    out.eta = found->eta;
  } else {
    from.fail("type",
              "\"" + type + "\" is not known; use \"homogeneous\", \"grid\", \"vdb\", \"procedural\" or \"preset\"");
  }
}

/// A medium that does nothing in some channel has no diffusion coefficient there.
void check_extinction(const Medium& medium, const Fields& from) {
  if (!all(medium.majorant(), [](double sigma_t) { return sigma_t > 0; }))
    from.fail("", "neither scatters nor absorbs in some channel; give a positive sigma_s or sigma_a there");
}

void read_emission(const Fields& material, const Fields& extensions, Material& out) {
  if (!material.has("emissiveFactor")) return;
  glm::dvec3 factor = non_negative(material, "emissiveFactor");
  Fields emissive = extensions.child("KHR_materials_emissive_strength");
  double strength = emissive.number_or("emissiveStrength", 1);
  if (strength < 0) emissive.fail("emissiveStrength", "must not be negative");
  out.radiance = glm::vec3(strength * factor);
  if (!all(out.radiance, [](double v) { return std::isfinite(v); })) emissive.fail("emissiveStrength", "is too large");
}

/// KHR_materials_specular scales what the surface mirrors at normal incidence. Here one index is both the mirror and
/// the refraction: the one that mirrors as much, (1 - eta)^2 / (1 + eta)^2 = specularFactor * specularColorFactor *
/// F_0.
void read_specular(const Fields& extensions, Material& out) {
  const std::string name = "KHR_materials_specular";
  if (!extensions.has(name)) return;
  const Fields specular = extensions.child(name);
  const double factor = specular.number_or("specularFactor", 1);
  if (factor < 0 || factor > 1) specular.fail("specularFactor", "must lie in 0..1");
  const glm::dvec3 colour =
      specular.has("specularColorFactor") ? non_negative(specular, "specularColorFactor") : glm::dvec3(1);
  if (colour.r != colour.g || colour.g != colour.b)
    out.warning = "the colour of specularColorFactor is not rendered; its mean is used";
  const double mirrored = factor * (colour.r + colour.g + colour.b) / 3;
  if (mirrored == 1) return;
  const double ratio = std::abs((out.eta - 1) / (out.eta + 1)) * std::sqrt(mirrored);
  if (ratio >= 0.9) specular.fail("specularColorFactor", "mirrors more than 81 %, which no dielectric does; lower it");
  const double eta = (1 + ratio) / (1 - ratio);
  out.eta = out.eta >= 1 ? eta : 1 / eta;
}

glm::vec3 base_colour(const Fields& material) {
  Fields pbr = material.child("pbrMetallicRoughness");
  if (!pbr.has("baseColorFactor")) return glm::vec3(1);
  glm::dvec4 colour = pbr.rgba("baseColorFactor");
  if (!all(glm::dvec3(colour), [](double v) { return v >= 0 && v <= 1; }))
    pbr.fail("baseColorFactor", "must lie in 0..1");
  return glm::vec3(colour);
}

/// Of a translucent surface. Where the material gives none, glTF's is 1; media of our own (`extras`) are polished.
double roughness(const Fields& material, bool extras) {
  Fields pbr = material.child("pbrMetallicRoughness");
  double value = pbr.number_or("roughnessFactor", extras ? 0 : 1);
  if (!(value >= 0 && value <= 1)) pbr.fail("roughnessFactor", "must lie in 0..1");
  return value;
}

}  // namespace

Material read_material(const Fields& material, GridCache& grids) {
  Material out;
  Fields extras = material.child(material.is_object("extras") ? "extras" : "");  // extras may be anything: glTF
  Fields extensions = material.child("extensions");
  const std::string draft = "KHR_materials_volume_scatter", renamed = "KHR_materials_scatter";
  std::string scatter = extensions.has(draft) ? draft : renamed;

  out.albedo = base_colour(material);
  out.two_sided = material.flag("doubleSided");
  read_emission(material, extensions, out);
  if (extras.has("medium") || extensions.has(scatter)) {
    out.role = Role::translucent;
    out.eta = 1.5;  // glTF's index of refraction where a material gives none
    if (extras.has("medium")) {
      read_extras_medium(extras.child("medium"), grids, out);
      check_extinction(out.medium, extras.child("medium"));
    } else {
      if (!extensions.has("KHR_materials_volume"))
        extensions.fail(scatter, "needs KHR_materials_volume beside it for attenuationColor and attenuationDistance");
      out.medium = khr_medium(extensions.child(scatter), extensions.child("KHR_materials_volume"));
      check_extinction(out.medium, extensions.child("KHR_materials_volume"));
    }
    if (extensions.has("KHR_materials_ior")) out.eta = extensions.child("KHR_materials_ior").number_or("ior", 1.5);
    if (out.eta <= 0) extensions.child("KHR_materials_ior").fail("ior", "must be positive (1 = index-matched)");
    read_specular(extensions, out);
    out.roughness = roughness(material, extras.has("medium"));
    if (out.radiance != glm::vec3(0)) out.warning = "emission of a translucent material is ignored";
    out.radiance = glm::vec3(0);
  } else if (out.radiance != glm::vec3(0)) {
    out.role = Role::emissive;
  } else if (extensions.has("KHR_materials_volume")) {
    out.warning = "a volume without scattering is not rendered as such; shown as an opaque surface";
  } else if (material.child("pbrMetallicRoughness").has("baseColorTexture")) {
    out.warning = "textures are not read; baseColorFactor is used";
  }
  return out;
}

glm::dmat4 place_pattern(const Pattern& pattern, const Bounds& bounds, std::uint32_t kind) {
  const glm::dvec3 edges = bounds.size();
  const double size =
      pattern.size.value_or(std::max({edges.x, edges.y, edges.z, 1e-30}) / (kind == solid_checker ? 8 : 1));
  const bool central = kind == solid_wood || kind == solid_agate;
  const glm::dvec3 origin = pattern.origin.value_or(glm::dvec3(central ? bounds.centre() : bounds.low));
  return glm::inverse(translation(origin) * scaling(glm::dvec3(size)));
}

}  // namespace alabaster

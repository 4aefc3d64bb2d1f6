#include "scene/write_gltf.h"

#include <algorithm>
#include <filesystem>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "image/picture.h"
#include "scene/files.h"
#include "scene/procedural.h"
#include "scene/vol.h"

namespace alabaster {
namespace {

using nlohmann::json;

json triple(glm::dvec3 v) { return json::array({v.x, v.y, v.z}); }

class Writer {
 public:
  explicit Writer(const std::string& path) : path_(path) {
    root_ = {{"asset", {{"version", "2.0"}, {"generator", "Alabaster"}}}, {"scene", 0}};
    root_["scenes"] = json::array({{{"nodes", json::array()}}});
  }

  void add(const Object& object) {
    if (object.mesh.triangles.empty()) throw std::invalid_argument("object '" + object.name + "' has no triangles");
    const int float_type = 5126, unsigned_type = 5125;
    Bounds bounds;
    for (glm::vec3 p : object.mesh.positions) bounds.add(p);
    int positions = accessor(
        object.mesh.positions.data(), object.mesh.positions.size(), sizeof(glm::vec3),
        {{"componentType", float_type}, {"type", "VEC3"}, {"min", triple(bounds.low)}, {"max", triple(bounds.high)}});
    int indices = accessor(object.mesh.triangles.data(), 3 * object.mesh.triangles.size(), sizeof(unsigned),
                           {{"componentType", unsigned_type}, {"type", "SCALAR"}});
    json primitive = {{"attributes", {{"POSITION", positions}}},
                      {"indices", indices},
                      {"material", push("materials", material(object))}};
    int mesh = push("meshes", {{"primitives", json::array({primitive})}});
    add_node({{"name", object.name}, {"mesh", mesh}});
  }

  void add(const Camera& camera) {
    int index = push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", camera.y_fov}, {"znear", 1e-3}}}});
    json matrix = json::array();
    for (int i = 0; i < 16; ++i) matrix.push_back(camera.to_world[i / 4][i % 4]);
    add_node({{"name", camera.name}, {"camera", index}, {"matrix", matrix}});
  }

  void add(const PunctualLight& light) {
    using Kind = PunctualLight::Kind;
    const bool far = light.kind == Kind::directional;
    const double most = std::max({light.intensity.r, light.intensity.g, light.intensity.b});
    json out = {{"name", light.name},
                {"type", light.kind == Kind::point ? "point"
                         : far                     ? "directional"
                                                   : "spot"},
                {"color", triple(most > 0 ? glm::dvec3(light.intensity) / most : glm::dvec3(1))},
                {"intensity", most},
                {"extras", {{far ? "angular_radius" : "radius", light.radius}}}};
    if (light.kind == Kind::spot)
      out["spot"] = {{"innerConeAngle", light.inner_cone}, {"outerConeAngle", light.outer_cone}};
    const std::string extension = "KHR_lights_punctual";
    json& list = root_["extensions"][extension]["lights"];
    list.push_back(std::move(out));
    use(extension);
    const glm::dvec3 to = light.direction, up = std::abs(to.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    const glm::dquat turn = glm::quatLookAt(to, up);
    add_node({{"name", light.name},
              {"translation", triple(light.position)},
              {"rotation", {turn.x, turn.y, turn.z, turn.w}},
              {"extensions", {{extension, {{"light", list.size() - 1}}}}}});
  }

  void add(const Environment& environment) {
    if (environment.picture) return add(*environment.picture);
    if (environment.radiance != glm::vec3(0))
      root_["scenes"][0]["extras"]["environment"]["radiance"] = triple(environment.radiance);
  }

  void add(const EnvironmentPicture& environment) {
    Picture picture{environment.size().x, environment.size().y, {}, {}};
    const char* const channels[] = {"R", "G", "B"};
    for (int c = 0; c < 3; ++c) {
      std::vector<float>& plane = picture.plane(channels[c]);
      for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = environment.texels()[i][c];
    }
    const std::filesystem::path path(path_);
    const std::string name = path.stem().string() + "-environment.exr";
    write_exr(picture, (path.parent_path() / name).string());
    root_["scenes"][0]["extras"]["environment"] = {{"exr", name}, {"rotation", 360 * environment.turn()}};
  }

  void write() {
    if (!used_.empty()) root_["extensionsUsed"] = used_;
    if (!buffer_.empty()) root_["buffers"] = json::array({{{"byteLength", buffer_.size()}}});
    std::string text = root_.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string bytes = "glTF";
    append(bytes, 2);  // version
    append(bytes, 12 + 8 + text.size() + (buffer_.empty() ? 0 : 8 + buffer_.size()));
    append(bytes, text.size());
    bytes += "JSON" + text;
    if (!buffer_.empty()) {
      append(bytes, buffer_.size());
      bytes += std::string("BIN\0", 4) + buffer_;
    }
    write_file(path_, bytes);
  }

 private:
  static void append(std::string& bytes, std::size_t value) {
    auto number = std::uint32_t(value);
    bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
  }

  int push(const std::string& list, json item) {
    root_[list].push_back(std::move(item));
    return int(root_[list].size()) - 1;
  }

  void add_node(json node) { root_["scenes"][0]["nodes"].push_back(push("nodes", std::move(node))); }

  /// `count` elements of `size` bytes, every component of them 4 bytes, so that all stays aligned.
  int accessor(const void* data, std::size_t count, std::size_t size, json description) {
    int view = push("bufferViews", {{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", count * size}});
    buffer_.append(static_cast<const char*>(data), count * size);
    description["bufferView"] = view;
    description["count"] = count;
    return push("accessors", std::move(description));
  }

  void extend(json& material, const std::string& name, json value) {
    material["extensions"][name] = std::move(value);
    use(name);
  }

  void use(const std::string& name) {
    if (std::find(used_.begin(), used_.end(), name) == used_.end()) used_.push_back(name);
  }

  json material(const Object& object) {
    json out = {{"name", object.name}, {"doubleSided", object.two_sided}};
    if (object.role == Role::translucent) {
      extend(out, "KHR_materials_ior", {{"ior", object.eta}});
      out["extras"]["medium"] = medium(object.medium);
      out["pbrMetallicRoughness"] = {{"metallicFactor", 0}, {"roughnessFactor", object.roughness}};
    } else if (object.role == Role::emissive) {
      double strength = std::max({object.radiance.r, object.radiance.g, object.radiance.b});
      out["emissiveFactor"] = triple(strength > 0 ? glm::dvec3(object.radiance) / strength : glm::dvec3(0));
      extend(out, "KHR_materials_emissive_strength", {{"emissiveStrength", strength}});
    } else {
      out["pbrMetallicRoughness"] = {{"baseColorFactor", {object.albedo.r, object.albedo.g, object.albedo.b, 1}},
                                     {"metallicFactor", 0},
                                     {"roughnessFactor", 1}};
    }
    return out;
  }

  json medium(const Medium& medium) {
    if (!medium.heterogeneous())
      return {{"type", "homogeneous"},
              {"sigma_s", triple(medium.homogeneous.sigma_s)},
              {"sigma_a", triple(medium.homogeneous.sigma_a)},
              {"g", medium.g}};
    if (medium.solid) return solid(medium);
    glm::dmat4 box = glm::inverse(medium.world_to_box);
    glm::dvec3 low(box[3]), size(box[0][0], box[1][1], box[2][2]);
    for (int column = 0; column < 3; ++column)
      for (int row = 0; row < 3; ++row)
        if (row == column ? box[column][row] <= 0 : box[column][row] != 0)
          throw std::invalid_argument("the box of a grid medium is not along the axes");
    const bool trilinear = (medium.sigma_t ? medium.sigma_t : medium.sigma_s)->trilinear;
    json out = {{"type", "grid"},
                {"g", medium.g},
                {"bbox_min", triple(low)},
                {"bbox_max", triple(low + size)},
                {"filter", trilinear ? "trilinear" : "nearest"}};
    if (medium.sigma_t) {
      out["sigma_t"] = {{"vol", vol(medium.sigma_t)}, {"scale", medium.scale}};
      out["albedo"] = {{"vol", vol(medium.albedo)}};
    } else {
      out["sigma_s"] = {{"vol", vol(medium.sigma_s)}};
      out["sigma_a"] = {{"vol", vol(medium.sigma_a)}};
      out["scale"] = medium.scale;
    }
    return out;
  }

  static json solid(const Medium& medium) {
    const ProceduralSolid& solid = *medium.solid;
    const glm::dmat4 frame = glm::inverse(medium.world_to_box);
    const double size = frame[0][0];
    for (int column = 0; column < 3; ++column)
      for (int row = 0; row < 3; ++row)
        if (std::abs(frame[column][row] - (row == column ? size : 0)) > 1e-9 * size)
          throw std::invalid_argument("the frame of a procedural solid is turned or stretched");
    json parts = json::array();
    for (int i = 0; i < parts_of(solid.kind); ++i)
      parts.push_back({{"sigma_s", triple(solid.parts[i].sigma_s)}, {"sigma_a", triple(solid.parts[i].sigma_a)}});
    json out = {{"type", "procedural"}, {"name", solid_names[solid.kind]}, {"g", medium.g},
                {"seed", solid.seed},   {"turbulence", solid.turbulence},  {"sharpness", solid.sharpness},
                {"parts", parts},       {"origin", triple(frame[3])},      {"size", size}};
    if (solid.kind == solid_skin) out["depths"] = {solid.depths.x, solid.depths.y};
    return out;
  }

  /// The name of the .vol file that holds `grid`, written on first use.
  std::string vol(const std::shared_ptr<const Grid>& grid) {
    std::filesystem::path path(path_);
    auto [entry, fresh] = vols_.try_emplace(grid.get());
    if (fresh) {
      entry->second = path.stem().string() + "-" + std::to_string(vols_.size() - 1) + ".vol";
      write_vol(*grid, (path.parent_path() / entry->second).string());
    }
    return entry->second;
  }

  std::string path_, buffer_;
  json root_;
  std::vector<std::string> used_;
  std::map<const Grid*, std::string> vols_;
};

}  // namespace

void write_gltf(const Scene& scene, const std::string& path) {
  Writer writer(path);
  for (const Object& object : scene.objects) writer.add(object);
  for (const Camera& camera : scene.cameras) writer.add(camera);
  for (const PunctualLight& light : scene.lights) writer.add(light);
  writer.add(scene.environment);
  writer.write();
}

}  // namespace alabaster

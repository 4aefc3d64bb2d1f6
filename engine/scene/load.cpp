#include "scene/load.h"

#include <cmath>
#include <filesystem>
#include <glm/gtc/quaternion.hpp>
#include <set>

#include "scene/depth.h"
#include "scene/document.h"
#include "scene/emission.h"
#include "scene/material.h"
#include "scene/mesh_check.h"
#include "scene/primitive.h"
#include "scene/procedural.h"
#include "scene/punctual.h"
#include "scene/shapes.h"

namespace alabaster {
namespace {

using nlohmann::json;

bool finite(const glm::dmat4& m) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!std::isfinite(m[column][row])) return false;
  return true;
}

glm::dmat4 local_transform(const tinygltf::Node& node) {
  glm::dmat4 m(1);
  if (node.matrix.size() == 16) {
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = node.matrix[i];
    return m;
  }
  if (node.translation.size() == 3) m = translation({node.translation[0], node.translation[1], node.translation[2]});
  if (node.rotation.size() == 4) {
    const std::vector<double>& q = node.rotation;  // x, y, z, w
    m *= glm::mat4_cast(glm::normalize(glm::dquat(q[3], q[0], q[1], q[2])));
  }
  if (node.scale.size() == 3) m *= scaling({node.scale[0], node.scale[1], node.scale[2]});
  return m;
}

/// Builds the Scene while walking the node tree.
class Builder {
 public:
  explicit Builder(const Document& document) : document_(document), model_(document.model) {
    scene_.path = document.path;
  }

  Scene build() {
    read_environment();
    for (int root : roots()) walk(root);
    check();
    resize();
    for (Object& object : scene_.objects) add_depth(object);
    give_extent(scene_);
    return std::move(scene_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw UserError(document_.path + ": " + what); }

  int scene_index() const { return model_.defaultScene >= 0 ? model_.defaultScene : 0; }

  std::vector<int> roots() const {
    if (!model_.scenes.empty()) {
      if (std::size_t(scene_index()) >= model_.scenes.size())
        fail("scene index is out of range; export the file again");
      return model_.scenes[scene_index()].nodes;
    }
    std::vector<bool> is_child(model_.nodes.size());
    for (const tinygltf::Node& node : model_.nodes)
      for (int child : node.children)
        if (child >= 0 && std::size_t(child) < is_child.size()) is_child[child] = true;
    std::vector<int> result;
    for (std::size_t i = 0; i < is_child.size(); ++i)
      if (!is_child[i]) result.push_back(int(i));
    return result;
  }

  /// Depth first with a stack of our own: a hostile file may nest as deep as it likes.
  void walk(int root) {
    struct Visit {
      int node;
      glm::dmat4 parent;
    };
    std::vector<Visit> stack{{root, glm::dmat4(1)}};
    while (!stack.empty()) {
      Visit visit = stack.back();
      stack.pop_back();
      if (visit.node < 0 || std::size_t(visit.node) >= model_.nodes.size())
        fail("node index " + std::to_string(visit.node) + " is out of range; export the file again");
      const tinygltf::Node& node = model_.nodes[visit.node];
      std::string name = node.name.empty() ? "node " + std::to_string(visit.node) : node.name;
      if (!visited_.insert(visit.node).second)
        fail("node '" + name + "' is reached twice; a node may have one parent only");
      glm::dmat4 to_world = visit.parent * local_transform(node);
      if (!finite(to_world)) fail("node '" + name + "': its transform is not finite; give finite numbers");
      if (node.mesh >= 0) add_mesh(node.mesh, node.name, to_world);
      add_light(visit.node, node.name, to_world);
      if (node.camera >= 0) add_camera(node.camera, node.name, to_world);
      for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
        stack.push_back({*child, to_world});
    }
  }

  void add_mesh(int index, const std::string& node_name, const glm::dmat4& to_world) {
    if (std::size_t(index) >= model_.meshes.size())
      fail("mesh index " + std::to_string(index) + " is out of range; export the file again");
    const tinygltf::Mesh& source = model_.meshes[index];
    std::string name = !node_name.empty()     ? node_name
                       : !source.name.empty() ? source.name
                                              : "mesh " + std::to_string(index);
    std::string place = document_.path + ": mesh '" + name + "'";
    std::map<int, Mesh> by_material;
    std::map<int, std::vector<glm::vec2>> texcoords;  // of those whose emission is textured
    for (const tinygltf::Primitive& primitive : source.primitives) {
      Mesh& mesh = by_material[primitive.material];
      mesh = joined(std::move(mesh), read_primitive(model_, primitive, place));
      const EmissionTexture& texture = emission(primitive.material);
      if (texture.empty()) continue;
      std::vector<glm::vec2>& all = texcoords[primitive.material];
      for (glm::vec2 at : read_texcoords(model_, primitive, texture.set, place)) all.push_back(at);
      if (all.size() != mesh.positions.size())
        throw UserError(place + " has an emissiveTexture and no TEXCOORD_" + std::to_string(texture.set) +
                        " at each of its vertices; export it with texture coordinates");
    }
    for (auto& [material, mesh] : by_material) {
      std::string object = by_material.size() == 1 ? name : name + "/" + material_name(material);
      if (mesh.triangles.empty())
        scene_.warnings.push_back("'" + object + "' has no triangles and is left out");
      else
        add_object(object, material, {std::move(mesh), std::move(texcoords[material])}, to_world);
    }
  }

  /// Empty where the material has none that shines.
  const EmissionTexture& emission(int index) {
    auto [entry, fresh] = emissions_.try_emplace(index);
    if (!fresh || index < 0 || material(index).role != Role::emissive) return entry->second;
    const tinygltf::TextureInfo& info = model_.materials[std::size_t(index)].emissiveTexture;
    if (info.index < 0) return entry->second;
    const std::string place = document_.path + ": material '" + material_name(index) + "': emissiveTexture";
    const auto there = [&](int i, std::size_t count) { return i >= 0 && std::size_t(i) < count; };
    if (!there(info.index, model_.textures.size()) || !there(model_.textures[info.index].source, model_.images.size()))
      throw UserError(place + ": its texture or image is out of range; export the file again");
    const tinygltf::Texture& texture = model_.textures[info.index];
    EmissionTexture& result = entry->second;
    result = decode_emission(model_.images[texture.source].image, place);
    result.set = info.texCoord;
    const auto wrap = [](int mode) {
      return mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? EmissionTexture::Wrap::clamp
             : mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? EmissionTexture::Wrap::mirror
                                                             : EmissionTexture::Wrap::repeat;
    };
    if (there(texture.sampler, model_.samplers.size())) {
      result.wrap[0] = wrap(model_.samplers[texture.sampler].wrapS);
      result.wrap[1] = wrap(model_.samplers[texture.sampler].wrapT);
    }
    if (info.extensions.contains("KHR_texture_transform"))
      scene_.warnings.push_back("material '" + material_name(index) +
                                "': KHR_texture_transform of its emissiveTexture is not read");
    return result;
  }

  std::string material_name(int index) const {
    if (index < 0 || std::size_t(index) >= model_.materials.size()) return "no material";
    const std::string& name = model_.materials[index].name;
    return name.empty() ? std::to_string(index) : name;
  }

  const Material& material(int index) {
    auto [entry, fresh] = materials_.try_emplace(index);
    if (fresh && index >= 0) {
      if (std::size_t(index) >= model_.materials.size())
        fail("material index " + std::to_string(index) + " is out of range; export the file again");
      std::string name = "material '" + material_name(index) + "'";
      entry->second = read_material(document_.fields("materials", index, name), grids_);
      if (!entry->second.warning.empty()) scene_.warnings.push_back(name + ": " + entry->second.warning);
    }
    return entry->second;
  }

  struct Shape {
    Mesh mesh;
    std::vector<glm::vec2> texcoords;  // where its emission is textured, one a vertex
  };

  void add_object(const std::string& name, int material_index, Shape shape, const glm::dmat4& to_world) {
    Mesh& mesh = shape.mesh;
    const Material& source = material(material_index);
    std::string place = document_.path + ": mesh '" + name + "'";
    const Bounds own_bounds = bounds_of(mesh);
    Object object{name,
                  source.role,
                  transformed(std::move(mesh), to_world),
                  source.medium,
                  source.eta,
                  source.albedo,
                  source.radiance,
                  source.two_sided,
                  source.roughness};
    for (glm::vec3 p : object.mesh.positions)
      if (!std::isfinite(p.x + p.y + p.z))
        throw UserError(place + " lies too far out for 32-bit floats; bring it nearer");
    if (source.role == Role::translucent) {
      if (source.medium.heterogeneous()) {
        const glm::dmat4 box = source.medium.solid
                                   ? place_pattern(source.pattern, own_bounds, source.medium.solid->kind)
                                   : source.medium.world_to_box;
        object.medium.world_to_box = box * glm::inverse(to_world);
        if (!finite(object.medium.world_to_box))
          throw UserError(place + ": its node flattens it; give a scale without zeros");
      }
      object.mesh = checked_solid(object.mesh, name, document_.path, scene_.warnings);
    } else {
      drop_flat(object);
    }
    if (object.mesh.triangles.empty()) return;
    if (shape.texcoords.empty()) {
      scene_.objects.push_back(std::move(object));
      return;
    }
    for (Object& part : cut_by_texels(object, shape.texcoords, emission(material_index), place))
      scene_.objects.push_back(std::move(part));
  }

  /// Opaque and emissive meshes may be open, but a triangle without area has no normal.
  void drop_flat(Object& object) {
    const std::vector<glm::vec3>& p = object.mesh.positions;
    std::size_t flat = std::erase_if(object.mesh.triangles, [&](glm::uvec3 t) {
      return glm::cross(glm::dvec3(p[t.y]) - glm::dvec3(p[t.x]), glm::dvec3(p[t.z]) - glm::dvec3(p[t.x])) ==
             glm::dvec3(0);
    });
    if (flat > 0)
      scene_.warnings.push_back("mesh '" + object.name + "': " + std::to_string(flat) +
                                " triangles without area dropped");
  }

  void add_light(int node_index, const std::string& node_name, const glm::dmat4& to_world) {
    const std::string extension = "KHR_lights_punctual";
    const Fields extensions = document_.fields("nodes", node_index, "node '" + node_name + "'").child("extensions");
    if (!extensions.has(extension)) return;
    const double index = extensions.child(extension).number("light");
    const json none = json::object();
    const json& root = document_.root.contains("extensions") ? document_.root["extensions"] : none;
    const json& all = root.contains(extension) ? root[extension] : none;
    const json& list = all.contains("lights") ? all["lights"] : none;
    if (!list.is_array() || !(index >= 0 && index < double(list.size())))
      fail("node '" + node_name + "' has a light whose index is out of range; export the file again");
    const json& source = list[std::size_t(index)];
    std::string name = node_name;
    if (name.empty()) name = source.value("name", "light " + std::to_string(int(index)));
    scene_.lights.push_back(
        read_punctual(Fields(source, document_.path, "light '" + name + "' "), to_world, scene_.warnings));
    scene_.lights.back().name = name;
  }

  void add_camera(int index, const std::string& node_name, const glm::dmat4& to_world) {
    if (std::size_t(index) >= model_.cameras.size())
      fail("camera index " + std::to_string(index) + " is out of range; export the file again");
    const tinygltf::Camera& source = model_.cameras[index];
    std::string name = !node_name.empty()     ? node_name
                       : !source.name.empty() ? source.name
                                              : "camera " + std::to_string(index);
    if (source.type != "perspective") {
      scene_.warnings.push_back("camera '" + name +
                                "' is orthographic and is left out; only perspective cameras are read");
      return;
    }
    Camera camera{name, glm::mat4(1), float(source.perspective.yfov)};
    if (!(camera.y_fov > 0 && camera.y_fov < 3.14159f))
      fail("camera '" + name + "' yfov must lie between 0 and pi (radians)");
    glm::dmat4 frame = to_world;
    for (int axis = 0; axis < 3; ++axis) {  // glTF: a camera's view ignores its node's scale
      double length = glm::length(frame[axis]);
      if (!(length > 0)) fail("camera '" + name + "': its node's scale is 0; give a scale without zeros");
      frame[axis] /= length;
    }
    camera.to_world = glm::mat4(frame);
    scene_.cameras.push_back(camera);
  }

  void read_environment() {
    if (model_.scenes.empty() || std::size_t(scene_index()) >= model_.scenes.size()) return;
    Fields source = document_.fields("scenes", scene_index(), "scene");
    if (!source.is_object("extras") || !source.child("extras").has("environment")) return;
    Fields environment = source.child("extras").child("environment");
    if (environment.has("exr")) return read_picture(environment);
    glm::dvec3 radiance = environment.rgb("radiance");
    if (glm::any(glm::lessThan(radiance, glm::dvec3(0)))) environment.fail("radiance", "must not be negative");
    scene_.environment.radiance = glm::vec3(radiance);
  }

  void read_picture(const Fields& environment) {
    if (environment.has("radiance")) environment.fail("radiance", "cannot stand beside \"exr\"; keep one of them");
    const double scale = environment.number_or("scale", 1), degrees = environment.number_or("rotation", 0);
    if (!(scale > 0)) environment.fail("scale", "must be positive");
    const std::string path = (std::filesystem::path(document_.path).parent_path() / environment.text("exr")).string();
    try {
      scene_.environment.picture = read_environment_picture(path, scale, std::remainder(degrees, 360.0) / 360);
    } catch (const UserError& error) {
      environment.fail("exr", std::string("cannot be used: ") + error.what());
    }
    const glm::ivec2 size = scene_.environment.picture->size();
    if (size.x != 2 * size.y)
      scene_.warnings.push_back(
          "environment: the picture is not twice as wide as it is high; it is taken as a whole "
          "sphere in latitude and longitude all the same");
  }

  /// scene.extras.size: how tall the translucent objects are, in metres, whatever the file's unit. All is scaled about
  /// the origin, lights so that they light as before; coefficients are in 1/m and stay.
  void resize() {
    if (model_.scenes.empty() || std::size_t(scene_index()) >= model_.scenes.size()) return;
    const Fields source = document_.fields("scenes", scene_index(), "scene");
    if (!source.is_object("extras") || !source.child("extras").has("size")) return;
    const Fields extras = source.child("extras");
    const double size = extras.number("size");
    if (size <= 0) extras.fail("size", "must be positive (metres)");
    Bounds bounds;
    for (const Object& object : scene_.objects)
      if (object.role == Role::translucent)
        for (const glm::vec3& p : object.mesh.positions) bounds.add(p);
    if (!(bounds.low.y < bounds.high.y)) extras.fail("size", "needs a translucent object, whose height it is");
    const double factor = size / double(bounds.size().y);
    for (Object& object : scene_.objects) {
      for (glm::vec3& p : object.mesh.positions) p = glm::vec3(factor * glm::dvec3(p));
      object.medium.world_to_box = object.medium.world_to_box * scaling(glm::dvec3(1 / factor));
    }
    for (Camera& camera : scene_.cameras)
      camera.to_world[3] = glm::vec4(glm::vec3(factor * glm::dvec3(camera.to_world[3])), 1);
    for (PunctualLight& light : scene_.lights) {
      light.position = glm::vec3(factor * glm::dvec3(light.position));
      if (light.kind == PunctualLight::Kind::directional) continue;
      light.intensity = glm::vec3(factor * factor * glm::dvec3(light.intensity));
      light.radius *= factor;
    }
  }

  void check() const {
    if (scene_.objects.empty()) fail("there are no triangles to render; put a mesh into the scene");
    if (scene_.cameras.empty()) fail("there is no camera; put a perspective camera into the scene");
    bool lit = !scene_.environment.dark();
    for (const Object& object : scene_.objects) lit |= object.role == Role::emissive && area(object.mesh) > 0;
    for (const PunctualLight& light : scene_.lights) lit |= light.intensity != glm::vec3(0);
    if (!lit)
      fail(
          "there is no light; add one (KHR_lights_punctual), give a mesh an emissiveFactor or set "
          "scene.extras.environment.radiance");
  }

  const Document& document_;
  const tinygltf::Model& model_;
  Scene scene_;
  std::map<int, Material> materials_;
  std::map<int, EmissionTexture> emissions_;
  GridCache grids_;
  std::set<int> visited_;
};

}  // namespace

Scene load_scene(const std::string& path) {
  Document document = open_document(path);
  try {
    return Builder(document).build();
  } catch (const json::exception& error) {  // a list that is no list, where tinygltf looked away
    throw unreadable(path, error.what());
  }
}

}  // namespace alabaster

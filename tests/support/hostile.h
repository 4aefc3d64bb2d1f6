// Malformed and hostile scenes, made afresh from a good one, with what the program must do about each.
#pragma once

#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "image/picture.h"
#include "scene/files.h"
#include "scene/scene.h"
#include "scene/shapes.h"
#include "scene/vol.h"
#include "scene/write_gltf.h"

namespace alabaster::test {

struct HostileScene {
  std::string name, path;
  bool expect_ok;                           // loads, with a warning that has the words
  std::vector<std::string> expected_words;  // in the error (or the warning)
  bool refused_by_loader = true;            // else load_scene() takes it and rendering must refuse it
};

/// A glass-like ball, a marble box with grids, ground, lamp and camera: "good.glb" before it is spoilt.
inline Scene good_scene() {
  Scene scene;
  Object ball;
  ball.name = "ball";
  ball.role = Role::translucent;
  ball.mesh = transformed(icosphere(2, 0.05f), translation({0, 0.05, 0}));
  ball.eta = 1.3;
  ball.medium.homogeneous = {{1000, 1000, 1000}, {1, 1, 1}};
  Object marble = ball;
  marble.name = "marble";
  marble.mesh = transformed(box({0.04f, 0.04f, 0.04f}), translation({0.1, 0.02, 0}));
  marble.medium.sigma_t = std::make_shared<Grid>(Grid{{2, 2, 2}, 1, std::vector<float>(8, 1000)});
  marble.medium.albedo = std::make_shared<Grid>(Grid{{2, 2, 2}, 3, std::vector<float>(24, 0.99f)});
  marble.medium.world_to_box = glm::inverse(translation({0.08, 0, -0.02}) * scaling(glm::dvec3(0.04)));
  Object ground;
  ground.name = "ground";
  ground.mesh = transformed(quad(1, 1), translation({0, -1e-3, 0}));
  Object lamp = ground;
  lamp.name = "lamp";
  lamp.role = Role::emissive;
  lamp.mesh = transformed(quad(0.1f, 0.1f), translation({0, 0.3, 0}) * rotation({1, 0, 0}, 180));
  lamp.radiance = {20, 20, 20};
  scene.objects = {ball, marble, ground, lamp};
  scene.cameras = {{"main", look_at({0, 0.1, 0.4}, {0.03, 0.04, 0}), 0.5f}};
  return scene;
}

/// A .glb taken apart.
struct Glb {
  nlohmann::json root;
  std::string buffer;

  static Glb read(const std::string& path) {
    std::string bytes = read_file(path);
    std::uint32_t length;
    std::memcpy(&length, bytes.data() + 12, sizeof length);
    return {nlohmann::json::parse(bytes.substr(20, length)), bytes.substr(20 + length + 8)};
  }

  std::string bytes(std::string text) const {
    text.resize((text.size() + 3) / 4 * 4, ' ');
    auto number = [](std::size_t value) {
      auto n = std::uint32_t(value);
      return std::string(reinterpret_cast<const char*>(&n), sizeof n);
    };
    return "glTF" + number(2) + number(20 + text.size() + 8 + buffer.size()) + number(text.size()) + "JSON" + text +
           number(buffer.size()) + std::string("BIN\0", 4) + buffer;
  }
  std::string bytes() const { return bytes(root.dump()); }

  template <typename T>
  void set(int accessor, std::size_t element, T value) {
    std::size_t view = root["accessors"][accessor]["bufferView"], offset = root["bufferViews"][view]["byteOffset"];
    std::memcpy(buffer.data() + offset + element * sizeof value, &value, sizeof value);
  }
};

/// Objects of good_scene() in their order; materials and meshes have the same indices, accessors are 2 i and 2 i + 1.
enum Part { ball, marble, ground, lamp };

class HostileMaker {
 public:
  explicit HostileMaker(const std::string& folder) : folder_(folder) {
    write_gltf(good_scene(), path("good.glb"));
    good_ = Glb::read(path("good.glb"));
  }

  std::vector<HostileScene> make() {
    files();
    meshes();
    media();
    lights_and_cameras();
    grids();
    return std::move(list_);
  }

 private:
  using Words = std::vector<std::string>;
  using json = nlohmann::json;

  std::string path(const std::string& file) const { return folder_ + "/" + file; }
  void add(const std::string& name, const std::string& file, Words words, bool ok = false) {
    list_.push_back({name, path(file), ok, std::move(words)});
  }
  void raw(const std::string& name, const std::string& bytes, Words words) {
    write_file(path(name + ".glb"), bytes);
    add(name, name + ".glb", std::move(words));
  }
  void edit(const std::string& name, const std::function<void(Glb&)>& change, Words words) {
    Glb glb = good_;
    change(glb);
    raw(name, glb.bytes(), std::move(words));
  }
  /// One field of the ball's extras.medium.
  void medium(const std::string& name, const std::string& key, const json& value, Words words) {
    words.push_back("extras.medium");
    edit(
        name, [&](Glb& glb) { glb.root["materials"][ball]["extras"]["medium"][key] = value; }, std::move(words));
  }
  void change(const std::string& name, const std::function<void(Scene&)>& spoil, Words words, bool ok = false) {
    Scene scene = good_scene();
    spoil(scene);
    write_gltf(scene, path(name + ".glb"));
    add(name, name + ".glb", std::move(words), ok);
  }

  void files() {
    add("missing_file", "nowhere.glb", {"no such file"});
    raw("empty_file", "", {"empty"});
    raw("garbage_text", "this is no scene at all, only words", {"not a readable glTF"});
    raw("garbage_binary", std::string("glTF\2\0\0\0\xff\xff\xff\xff\xff\xff\xff\xffJSON{\"a\"", 24),
        {"not a readable glTF"});
    std::string whole = good_.bytes();
    raw("truncated", whole.substr(0, whole.size() / 2), {"not a readable glTF", "truncated"});
    raw("truncated_header", whole.substr(0, 10), {"not a readable glTF"});
    std::string deep(200000, '[');
    raw("deep_json",
        good_.bytes("{\"asset\":{\"version\":\"2.0\"},\"extras\":" + deep + std::string(200000, ']') + "}"),
        {"nested"});
    json gltf = good_.root;
    gltf["buffers"][0]["uri"] = "nowhere.bin";
    raw("missing_buffer", gltf.dump(), {"nowhere.bin"});
    edit("required_extension", [](Glb& glb) { glb.root["extensionsRequired"] = {"EXT_magic"}; }, {"EXT_magic"});
  }

  void meshes() {
    edit("nan_positions", [](Glb& glb) { glb.set(2 * ball, 5, glm::vec3(0, NAN, 0)); }, {"mesh 'ball'", "not finite"});
    edit("infinite_positions", [](Glb& glb) { glb.set(2 * ground, 0, glm::vec3(INFINITY)); },
         {"mesh 'ground'", "not finite"});
    edit("vertex_out_of_range", [](Glb& glb) { glb.set(2 * ball + 1, 7, 162u); },
         {"mesh 'ball'", "162", "out of range"});
    edit("accessor_out_of_range",
         [](Glb& glb) { glb.root["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 99; },
         {"99", "out of range"});
    edit("accessor_past_buffer", [](Glb& glb) { glb.root["accessors"][0]["count"] = 4000000000u; }, {"out of range"});
    edit("no_triangles",
         [](Glb& glb) {
           for (json& node : glb.root["nodes"]) node.erase("mesh");
         },
         {"no triangles"});
    edit("mesh_out_of_range", [](Glb& glb) { glb.root["nodes"][0]["mesh"] = 77; }, {"77", "out of range"});
    edit("node_cycle", [](Glb& glb) { glb.root["nodes"][0]["children"] = {0}; }, {"reached twice"});
    edit("zero_scale", [](Glb& glb) { glb.root["nodes"][0]["scale"] = {0, 0, 0}; }, {"mesh 'ball'"});
    change(
        "degenerate_triangles",
        [](Scene& s) {
          s.objects[ball].mesh.triangles.push_back({1, 1, 2});
        },
        {"degenerate"}, true);
    change("zero_area",
           [](Scene& s) {
             for (glm::vec3& p : s.objects[ball].mesh.positions) p.y = 0, p.z = 0;
           },
           {"mesh 'ball'", "no area"});
    change("open_mesh", [](Scene& s) { s.objects[ball].mesh.triangles.resize(200); },
           {"mesh 'ball'", "hole", "edges around"});
    change(
        "inverted_mesh", [](Scene& s) { s.objects[ball].mesh = flipped(s.objects[ball].mesh); }, {"inside out"}, true);
    change(
        "small_hole", [](Scene& s) { s.objects[ball].mesh.triangles.pop_back(); }, {"filled"}, true);
  }

  void media() {
    medium("negative_sigma_s", "sigma_s", {1000, -1, 1000}, {"sigma_s", "negative"});
    medium("negative_sigma_a", "sigma_a", -0.5, {"sigma_a", "negative"});
    medium("null_sigma_a", "sigma_a", json::array({1, nullptr, 1}), {"sigma_a", "finite"});
    medium("text_sigma_s", "sigma_s", "nan", {"sigma_s", "finite"});
    medium("g_of_one", "g", 1.0, {".g", "between -1 and 1"});
    medium("unknown_type", "type", "jelly", {"type", "jelly"});
    edit("unknown_preset",
         [](Glb& glb) {
           glb.root["materials"][ball]["extras"]["medium"] = {{"type", "preset"}, {"name", "cheese"}};
         },
         {"cheese", "marble"});
    edit("empty_medium",
         [](Glb& glb) {
           json& m = glb.root["materials"][ball]["extras"]["medium"];
           m["sigma_s"] = m["sigma_a"] = 0;
         },
         {"neither scatters nor absorbs"});
    for (const char* number : {"NaN", "1e999"}) {  // no JSON, and a number beyond every double
      std::string text = good_.root.dump(), from = "\"g\":0.0";
      raw(std::string("coefficient_") + number,
          good_.bytes(text.replace(text.find(from), from.size(), std::string("\"g\":") + number)),
          {"not a readable glTF"});
    }
    for (double ior : {0.0, -1.5})
      edit(ior < 0 ? "negative_eta" : "zero_eta",
           [&](Glb& glb) { glb.root["materials"][ball]["extensions"]["KHR_materials_ior"]["ior"] = ior; },
           {"ior", "positive"});
    edit("scatter_without_volume",
         [](Glb& glb) {
           glb.root["materials"][ball].erase("extras");
           glb.root["materials"][ball]["extensions"]["KHR_materials_volume_scatter"] = {
               {"multiscatterColor", {1, 1, 1}}};
         },
         {"KHR_materials_volume"});
  }

  void lights_and_cameras() {
    change("no_light", [](Scene& s) { s.objects.pop_back(); }, {"no light"});
    change("no_camera", [](Scene& s) { s.cameras.clear(); }, {"no camera"});
    edit("bad_yfov", [](Glb& glb) { glb.root["cameras"][0]["perspective"]["yfov"] = 0; }, {"yfov"});
    edit("negative_emission",
         [](Glb& glb) {
           glb.root["materials"][lamp]["emissiveFactor"] = {-1, 0, 0};
         },
         {"emissiveFactor", "negative"});
    edit("negative_environment",
         [](Glb& glb) {
           glb.root["scenes"][0]["extras"]["environment"] = {{"radiance", {-1, 0, 0}}};
         },
         {"environment.radiance", "negative"});
    environments();
    change("camera_inside", [](Scene& s) { s.cameras[0].to_world = look_at({0, 0.05, 0}, {1, 0.05, 0}); }, {"camera"});
    list_.back().refused_by_loader = false;
  }

  void environment(const std::string& name, nlohmann::json value, Words words) {
    edit(
        name, [&](Glb& glb) { glb.root["scenes"][0]["extras"]["environment"] = value; }, std::move(words));
  }
  void sky(const std::string& name, const char* channel, float value, Words words) {
    Picture picture{4, 2, {}, {}};
    for (const char* c : {"R", "G", channel}) picture.plane(c).assign(8, 1);
    picture.plane(channel)[6] = value;
    write_exr(picture, path(name + ".exr"));
    environment(name, {{"exr", name + ".exr"}}, std::move(words));
  }
  void environments() {
    const std::string field = "environment.exr";
    environment("environment_missing", {{"exr", "nowhere.exr"}}, {field, "nowhere.exr"});
    environment("environment_number", {{"exr", 3}}, {field});
    environment("environment_twice", {{"exr", "sky.exr"}, {"radiance", {1, 1, 1}}}, {"environment.radiance", "exr"});
    write_file(path("words.exr"), "these are words");
    environment("environment_words", {{"exr", "words.exr"}}, {field, "words.exr", "cannot be read as an EXR"});
    sky("environment_nan", "B", NAN, {field, "(2, 1)", "channel B", "finite"});
    sky("environment_endless", "B", INFINITY, {field, "(2, 1)", "channel B", "finite"});
    sky("environment_negative", "B", -1, {field, "(2, 1)", "channel B", "negative"});
    sky("environment_channel", "Q", 1, {field, "no channel B"});
    sky("environment_good", "B", 1, {});
    list_.back().expect_ok = true;
    environment("environment_scale", {{"exr", "environment_good.exr"}, {"scale", -1}}, {"environment.scale"});
    environment("environment_rotation", {{"exr", "environment_good.exr"}, {"rotation", "up"}}, {"environment.rotation"});
    const std::string whole = read_file(path("environment_good.exr"));
    write_file(path("cut.exr"), whole.substr(0, whole.size() - 10));
    environment("environment_cut", {{"exr", "cut.exr"}}, {field, "cut.exr"});
    Picture black{2, 1, {}, {}};
    for (const char* c : {"R", "G", "B"}) black.plane(c);
    write_exr(black, path("black.exr"));
    environment("environment_black", {{"exr", "black.exr"}}, {field, "black everywhere"});
  }

  void vol(const std::string& name, const std::string& key, const std::string& bytes, Words words) {
    write_file(path(name + ".vol"), bytes);
    words.push_back(key);
    edit(
        name, [&](Glb& glb) { glb.root["materials"][marble]["extras"]["medium"][key]["vol"] = name + ".vol"; },
        std::move(words));
  }

  void grids() {
    edit("missing_vol",
         [](Glb& glb) { glb.root["materials"][marble]["extras"]["medium"]["albedo"]["vol"] = "nowhere.vol"; },
         {"albedo.vol", "nowhere.vol", "no such file"});
    std::string bytes = read_file(path("good-0.vol"));
    vol("vol_wrong_size", "sigma_t", bytes.substr(0, bytes.size() - 4), {"wrong size"});
    vol("vol_too_short", "sigma_t", bytes.substr(0, 20), {"48 bytes"});
    vol("vol_not_a_vol", "sigma_t", std::string(100, 'x'), {"begin with VOL"});
    auto with = [&](float value) {
      std::string copy = bytes;
      std::memcpy(copy.data() + 48 + 4 * 3, &value, 4);
      return copy;
    };
    vol("vol_nan", "sigma_t", with(NAN), {"finite"});
    vol("vol_negative", "sigma_t", with(-1), {"negative"});
    vol("vol_albedo_above_one", "albedo", with(0.5f), {"above 1"});
    std::string huge = bytes;
    std::int32_t edge = 2000000000;
    for (int axis = 0; axis < 3; ++axis) std::memcpy(huge.data() + 8 + 4 * axis, &edge, 4);
    vol("vol_huge", "sigma_t", huge, {"grid size"});
    edit("flat_box",
         [](Glb& glb) {
           glb.root["materials"][marble]["extras"]["medium"]["bbox_max"] = {0, 0, 0};
         },
         {"bbox_max"});
  }

  std::string folder_;
  Glb good_;
  std::vector<HostileScene> list_;
};

/// Writes every hostile scene (and "good.glb") into `folder`.
inline std::vector<HostileScene> make_hostile_scenes(const std::string& folder) { return HostileMaker(folder).make(); }

}  // namespace alabaster::test

// A scene with its meshes on the device, its lights and its shadow maps: what the tests of lighting/ and shading/ start
// from.
#pragma once

#include "lighting/lighting.h"
#include "scene/shapes.h"
#include "support/device.h"

namespace alabaster {

struct LitScene {
  LitScene(gpu::Context& c, Scene s, const LightSettings& settings)
      : context(c), scene(std::move(s)), meshes(upload_meshes(c, scene)), lighting(c, scene, meshes, settings) {
    gpu::Commands commands(context);
    lighting.record_shadow_maps(commands);
    commands.submit();
  }

  std::vector<glm::vec3> gather(const std::vector<Receiver>& receivers, double eta) const {
    const gpu::Buffer in = gpu::make_buffer(context, receivers, "receivers");
    const gpu::Buffer out(context, receivers.size() * sizeof(glm::vec3), "flux");
    gpu::Commands commands(context);
    lighting.record_gather(commands, in, static_cast<std::uint32_t>(receivers.size()), eta, out);
    commands.submit();
    std::vector<glm::vec3> flux = gpu::download<glm::vec3>(context, out);
    flux.resize(receivers.size());
    return flux;
  }

  gpu::Context& context;
  Scene scene;
  SceneMeshes meshes;
  Lighting lighting;
};

inline Object make_object(Role role, Mesh mesh) {
  Object object;
  object.role = role;
  object.mesh = std::move(mesh);
  return object;
}

inline Object make_light(Mesh mesh, glm::vec3 radiance, bool two_sided = false) {
  Object object = make_object(Role::emissive, std::move(mesh));
  object.radiance = radiance;
  object.two_sided = two_sided;
  return object;
}

/// A torus below a lamp.
inline Scene torus_under_lamp(double eta) {
  Scene scene;
  scene.objects = {
      make_object(Role::translucent, torus(1, 0.4f, 48, 24)),
      make_light(transformed(quad(0.6f, 0.6f), translation({0.5, 3, 0.2}) * rotation({1, 0, 0}, 180)), {30, 50, 70})};
  scene.objects[0].eta = eta;
  return scene;
}

/// One receiver in the middle of every triangle.
inline std::vector<Receiver> face_receivers(const Mesh& mesh) {
  std::vector<Receiver> receivers;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::vec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
    receivers.push_back({(a + b + c) / 3.0f, glm::normalize(glm::cross(b - a, c - a)), 0});
  }
  return receivers;
}

}  // namespace alabaster

// The furnace: an object that absorbs nothing in uniform light of radiance 1 must look exactly as bright as the light,
// reflection and transmission together (theory: conservation of energy and of etendue).
#pragma once

#include <algorithm>
#include <cmath>

#include "pipeline/render.h"
#include "scene/shapes.h"

namespace alabaster::test {

inline Scene furnace_scene(Mesh mesh, double eta, double g = 0) {
  Scene scene;
  scene.path = "furnace";
  Object object;
  object.name = "object";
  object.role = Role::translucent;
  const Bounds bounds = bounds_of(mesh);
  object.mesh = std::move(mesh);
  object.eta = eta;
  object.medium.homogeneous.sigma_s = glm::dvec3(20 / (1 - g));
  object.medium.g = g;
  scene.objects.push_back(std::move(object));
  Camera camera;
  const float distance = 1.6f * glm::length(bounds.size());
  camera.to_world =
      glm::mat4(look_at(glm::dvec3(bounds.centre()) + glm::dvec3(distance * glm::normalize(glm::vec3(0.5f, 0.6f, 1.f))),
                        glm::dvec3(bounds.centre())));
  scene.cameras.push_back(camera);
  scene.environment.radiance = glm::vec3(1);
  return scene;
}

struct FurnaceResult {
  double mean = 0;   // of R, G, B over the object's whole pixels; 1 is right
  double worst = 0;  // largest |value - 1|
  std::size_t pixels = 0;
};

inline FurnaceResult furnace_figures(const Picture& picture) {
  FurnaceResult result;
  const std::vector<float>& cover = picture.channels.at("object.Y");
  for (const char* name : {"R", "G", "B"})
    for (std::size_t i = 0; i < cover.size(); ++i)
      if (cover[i] > 0.999f) {
        const double value = picture.channels.at(name)[i];
        result.mean += value;
        result.worst = std::max(result.worst, std::abs(value - 1));
        ++result.pixels;
      }
  result.mean /= double(result.pixels);
  return result;
}

}  // namespace alabaster::test

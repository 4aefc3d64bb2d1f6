// Scenes and estimators that the reference's tests share.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <cmath>
#include <functional>

#include "reference/paths.h"
#include "scene/shapes.h"

namespace alabaster::testing_scenes {

struct Estimate {
  glm::dvec3 mean{0}, error{0};  // and its standard error
};

struct Ray {
  glm::vec3 origin, direction;
};

/// Mean radiance over `paths` camera rays that `draw(random)` gives.
inline Estimate radiance(const World& world, std::uint64_t paths, std::uint64_t seed,
                         const std::function<Ray(Random&)>& draw) {
  struct Sum {
    glm::dvec3 first{0}, second{0};
  };
  const Sum sum = tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::uint64_t>(0, paths, 1024), Sum{},
      [&](const tbb::blocked_range<std::uint64_t>& range, Sum s) {
        for (std::uint64_t i = range.begin(); i < range.end(); ++i) {
          Random random(seed, i, 0);
          const Ray ray = draw(random);
          const PathSample sample = trace_path(world, ray.origin, ray.direction, world.inside_at(ray.origin), random);
          const glm::dvec3 value(sample.radiance[0] + sample.radiance[1] + sample.radiance[2]);
          s.first += value;
          s.second += value * value;
        }
        return s;
      },
      [](const Sum& a, const Sum& b) {
        return Sum{a.first + b.first, a.second + b.second};
      });
  const double n = static_cast<double>(paths);
  Estimate e;
  e.mean = sum.first / n;
  e.error = glm::sqrt(glm::max(glm::dvec3(0), sum.second / n - e.mean * e.mean) / (n - 1));
  return e;
}

inline Medium homogeneous(glm::dvec3 sigma_s, glm::dvec3 sigma_a, double g = 0) {
  Medium medium;
  medium.homogeneous = {sigma_s, sigma_a};
  medium.g = g;
  return medium;
}

inline Object translucent(Mesh mesh, Medium medium, double eta) {
  Object object;
  object.name = "object";
  object.role = Role::translucent;
  object.mesh = std::move(mesh);
  object.medium = std::move(medium);
  object.eta = eta;
  return object;
}

inline Object emitter(Mesh mesh, glm::vec3 radiance, bool two_sided = false) {
  Object object;
  object.name = "light";
  object.role = Role::emissive;
  object.mesh = std::move(mesh);
  object.radiance = radiance;
  object.two_sided = two_sided;
  return object;
}

inline Object opaque(Mesh mesh, glm::vec3 albedo) {
  Object object;
  object.name = "wall";
  object.role = Role::opaque;
  object.mesh = std::move(mesh);
  object.albedo = albedo;
  return object;
}

/// A slab from z = 0 down to z = -thickness, `width` across, in a unit environment that a black plate below it cuts
/// down to the upper hemisphere. Radiance seen from above in a direction is the reflectance for light from there
/// (reciprocity), seen from below the transmittance.
inline Scene slab(double thickness, double width, Medium medium, double eta) {
  Scene scene;
  scene.environment.radiance = glm::vec3(1);
  const auto t = static_cast<float>(thickness), w = static_cast<float>(width);
  scene.objects.push_back(
      translucent(transformed(box({w, w, t}), translation({0, 0, -thickness / 2})), std::move(medium), eta));
  scene.objects.push_back(
      opaque(transformed(box({4 * w, 4 * w, t}), translation({0, 0, -1.502 * thickness})), glm::vec3(0)));
  return scene;
}

inline glm::vec3 cosine_direction(Random& random, float side) {
  const float c = std::sqrt(1 - random.uniform());
  return around({0, 0, side}, c, random.uniform());
}

/// What a slab() reflects or transmits of diffuse light.
inline Estimate diffuse(const World& world, double thickness, bool transmitted, std::uint64_t paths,
                        std::uint64_t seed) {
  const auto t = static_cast<float>(thickness);
  return radiance(world, paths, seed, [&](Random& random) {
    if (transmitted) return Ray{{0.01f, 0.02f, -1.001f * t}, cosine_direction(random, 1)};
    return Ray{{0.01f, 0.02f, 0.001f * t}, cosine_direction(random, -1)};
  });
}

/// Of light that falls in along the normal.
inline Estimate normal(const World& world, double thickness, bool transmitted, std::uint64_t paths,
                       std::uint64_t seed) {
  const auto t = static_cast<float>(thickness);
  const Ray ray =
      transmitted ? Ray{{0.01f, 0.02f, -1.001f * t}, {0, 0, 1}} : Ray{{0.01f, 0.02f, 0.001f * t}, {0, 0, -1}};
  return radiance(world, paths, seed, [&](Random&) { return ray; });
}

}  // namespace alabaster::testing_scenes

// Scenes and estimators that the reference's tests share.
#pragma once

#include <gtest/gtest.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>

#include "compare/compare.h"
#include "reference/paths.h"
#include "scene/shapes.h"

namespace alabaster::testing_scenes {

struct Estimate {
  glm::dvec3 mean{0}, error{0};  // and its standard error
};

struct Ray {
  glm::vec3 origin, direction;
};

/// ALABASTER_STUDY=N takes N times the paths, and slabs ask for 0.3 % as well: the proof that is too long for every
/// build. Of what it prints, grep '^|' makes the README's table. Each row has its own seed: one chance for all would
/// make their deviations one.
inline std::uint64_t study_factor() {
  const char* text = std::getenv("ALABASTER_STUDY");
  return text ? std::strtoull(text, nullptr, 10) : 1;
}

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

inline Camera looking_at_origin(glm::dvec3 eye, float y_fov) {
  Camera camera;
  camera.name = "main";
  camera.to_world = look_at(eye, {0, 0, 0});
  camera.y_fov = y_fov;
  return camera;
}

/// By the Z-test: the mean, the pixels beyond 3 sigma, and the mean square of all.
inline void expect_equal(const Picture& test, const Picture& reference, const char* what, double most_noise = 0.06) {
  const Comparison c = compare(test, reference);
  ASSERT_TRUE(c.z);
  std::printf("%-36s noise %.2f %%, bias %+.3f %% (%+.1f s.e. at least), %.2f %% beyond 3 sigma, mean z^2 %.3f\n", what,
              100 * c.z->noise, 100 * c.all.bias, c.z->bias_z, 100 * c.z->rejected, c.z->mean_square);
  EXPECT_LT(std::abs(c.z->bias_z), 3) << what;
  // What chance alone exceeds once in a thousand times, the three channels of a pixel counted as one.
  const double n = static_cast<double>(c.pixels);
  EXPECT_LT(c.z->rejected, 0.0027 + 3.1 * std::sqrt(0.0027 / n) + 1 / n) << what;
  EXPECT_LT(c.z->mean_square, 1 + 3.1 * std::sqrt(2 / n)) << what;
  EXPECT_LT(c.z->noise, most_noise) << what << ": too few samples to say anything";
}

/// A grid medium whose every cell has the given values.
inline Medium constant_grid(glm::vec3 sigma_t, glm::vec3 albedo, double g, double half_size) {
  auto grid_of = [](glm::vec3 value) {
    auto grid = std::make_shared<Grid>();
    grid->size = {5, 4, 3};
    grid->channels = 3;
    for (int i = 0; i < 60; ++i) grid->values.insert(grid->values.end(), {value.x, value.y, value.z});
    return grid;
  };
  Medium medium;
  medium.g = g;
  medium.sigma_t = grid_of(sigma_t);
  medium.albedo = grid_of(albedo);
  medium.world_to_box = scaling(glm::dvec3(0.5 / half_size)) * translation(glm::dvec3(half_size));
  return medium;
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

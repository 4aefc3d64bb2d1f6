// The path tracer against closed forms, conservation laws and other estimators.
#include <gtest/gtest.h>

#include "compare/compare.h"
#include "physics/reference_scenes.h"
#include "reference/reference.h"

namespace alabaster {
namespace {
using namespace testing_scenes;

Picture constant_picture(int width, int height, float value) {
  Picture picture{width, height, {}, {}};
  for (const char* c : {"R", "G", "B"}) picture.plane(c).assign(static_cast<std::size_t>(width * height), value);
  return picture;
}

// A lossless object in a lit box (walls of radiance 1) must look like its walls, whatever its colours, index, phase
// function and shape. The walls are an area light, so next-event estimation takes part at eta 1.
TEST(ReferenceTransport, FurnaceOfLightWalls) {
  for (double eta : {1.0, 1.3, 1.5})
    for (double g : {0.0, 0.9}) {
      Scene scene;
      scene.objects.push_back(translucent(torus(0.6f, 0.3f, 24, 12),
                                          homogeneous({2 / (1 - g), 4 / (1 - g), 7 / (1 - g)}, glm::dvec3(0), g), eta));
      scene.objects.push_back(emitter(flipped(box({6, 6, 6})), glm::vec3(1)));
      scene.cameras.push_back(looking_at_origin({0.4, 1.5, 1.0}, 0.9f));
      ReferenceOptions options;
      options.width = options.height = 16;
      options.samples = 500;
      char what[60];
      std::snprintf(what, sizeof what, "furnace eta %.1f g %.1f", eta, g);
      expect_equal(constant_picture(16, 16, 1), render_reference(scene, options), what);
    }
}

TEST(ReferenceTransport, ConstantGridIsTheHomogeneousMedium) {
  for (bool grey : {true, false}) {
    const glm::vec3 sigma_t = grey ? glm::vec3(4) : glm::vec3(2, 4, 8), albedo(0.95f, 0.9f, 0.8f);
    Scene scene;
    scene.environment.radiance = glm::vec3(0.3f);
    scene.objects.push_back(translucent(
        icosphere(2), homogeneous(glm::dvec3(sigma_t * albedo), glm::dvec3(sigma_t * (1.0f - albedo)), 0.4), 1.0));
    scene.objects.push_back(emitter(transformed(quad(2, 2), translation({0, -3, 0})), glm::vec3(4)));
    scene.cameras.push_back(looking_at_origin({0, 0, 4}, 0.6f));
    ReferenceOptions options;
    options.width = options.height = 16;
    options.samples = 800;
    const Picture homogeneous_picture = render_reference(scene, options);
    scene.objects[0].medium = constant_grid(sigma_t, albedo, 0.4, 1);
    options.seed = 1;
    expect_equal(render_reference(scene, options), homogeneous_picture, grey ? "grid, grey" : "grid, coloured");
  }
}

// Index-matched, the lights are seen through the surface (next-event estimation); at eta 1.0001, where nothing else
// changes, they are only found by chance.
TEST(ReferenceTransport, NextEventEstimationAgreesWithChance) {
  Scene scene;
  scene.objects.push_back(translucent(icosphere(2), homogeneous({4, 2, 1}, {0.1, 0.1, 0.4}, -0.3), 1.0));
  scene.objects.push_back(emitter(transformed(flipped(quad(5, 5)), translation({0, 2, 0})), glm::vec3(1)));
  scene.objects.push_back(opaque(transformed(quad(6, 6), translation({0, -1, 0})), glm::vec3(0.7f)));
  scene.cameras.push_back(looking_at_origin({0, 0.5, 4}, 0.6f));
  ReferenceOptions options;
  options.width = options.height = 16;
  options.samples = 2000;
  const Picture seen = render_reference(scene, options);
  scene.objects[0].eta = 1.0001;
  options.seed = 1;
  expect_equal(render_reference(scene, options), seen, "next-event estimation");
}

// On curved and concave meshes, faceted coarsely so that many ways have two bends: aiming at a lamp through the surface
// agrees with meeting it by chance, and is the less noisy of the two.
TEST(ReferenceTransport, AimingThroughTheSurfaceAgreesWithChance) {
  for (const Mesh& mesh : {icosphere(2), torus(0.7f, 0.35f, 24, 12)}) {
    Scene scene;
    scene.objects.push_back(translucent(mesh, homogeneous(glm::dvec3(6), glm::dvec3(0.1), 0.3), 1.4));
    scene.objects.push_back(emitter(transformed(flipped(quad(1, 1)), translation({0, 1.8, 0})), glm::vec3(10)));
    const World aiming(scene, Guiding::always), chance(scene, Guiding::never);
    const auto draw = [](Random& random) {
      const glm::vec3 eye(0.8f, 3, 2), at(random.uniform() - 0.5f, 0, random.uniform() - 0.5f);
      return Ray{eye, glm::normalize(at - eye)};
    };
    const Estimate aimed = radiance(aiming, 60000, 40, draw), met = radiance(chance, 400000, 41, draw);
    std::printf("aimed %.4f +- %.4f, by chance %.4f +- %.4f\n", aimed.mean.x, aimed.error.x, met.mean.x, met.error.x);
    EXPECT_NEAR(aimed.mean.x, met.mean.x, 3 * std::hypot(aimed.error.x, met.error.x));
    EXPECT_LT(met.error.x, 0.02 * met.mean.x);
    EXPECT_LT(aimed.error.x * std::sqrt(60000.0), met.error.x * std::sqrt(400000.0));
  }
}

// A medium that varies, against brute force: unscattered light by quadrature, once scattered light by marching both
// legs in small steps through Medium::at, which the tracer does not use.
TEST(ReferenceTransport, VaryingGridAgreesWithRayMarching) {
  auto sigma_t = std::make_shared<Grid>(), albedo = std::make_shared<Grid>();
  Random random(5, 0, 0);
  sigma_t->size = {6, 5, 7};
  albedo->size = {3, 3, 3};
  sigma_t->channels = albedo->channels = 3;
  for (int i = 0; i < 6 * 5 * 7 * 3; ++i)
    sigma_t->values.push_back(random.uniform() < 0.3f ? 0.0f : 2 * random.uniform());
  for (int i = 0; i < 27 * 3; ++i) albedo->values.push_back(random.uniform());
  Medium medium;
  medium.g = 0.5;
  medium.sigma_t = sigma_t;
  medium.albedo = albedo;
  medium.scale = 1.5;
  // Smaller than the object, so the clamping outside the box takes part too.
  medium.world_to_box = translation(glm::dvec3(0.5)) * scaling(glm::dvec3(0.6)) * rotation({1, 2, 3}, 40);
  Scene scene;
  scene.environment.radiance = glm::vec3(1);
  scene.objects.push_back(translucent(box({2, 2, 2}), medium, 1.0));
  World world(scene);
  const glm::vec3 origin(0.21f, -0.13f, 3), direction = glm::normalize(glm::vec3(-0.12f, 0.23f, -2));

  glm::dvec3 first(0), second(0);
  const int paths = 300000;
  for (int i = 0; i < paths; ++i) {
    Random path_random(2, static_cast<std::uint64_t>(i), 0);
    const glm::dvec3 value(
        trace_path(world, origin, direction, {}, path_random).radiance[static_cast<int>(Layer::single)]);
    first += value;
    second += value * value;
  }
  const glm::dvec3 traced = first / static_cast<double>(paths);
  const glm::dvec3 traced_error =
      glm::sqrt((second / static_cast<double>(paths) - traced * traced) / static_cast<double>(paths));

  auto exit_distance = [](glm::dvec3 o, glm::dvec3 d) {  // from inside the box
    double t = INFINITY;
    for (int axis = 0; axis < 3; ++axis)
      if (d[axis] != 0) t = std::min(t, ((d[axis] > 0 ? 1 : -1) - o[axis]) / d[axis]);
    return t;
  };
  auto depth = [&](glm::dvec3 o, glm::dvec3 d, double length, int steps) {
    glm::dvec3 sum(0);
    for (int k = 0; k < steps; ++k) {
      const Coefficients c = medium.at(o + d * (length * (k + 0.5) / steps));
      sum += (c.sigma_s + c.sigma_a) * (length / steps);
    }
    return sum;
  };
  const glm::dvec3 d(direction), entry = glm::dvec3(origin) + d * ((1 - static_cast<double>(origin.z)) / d.z);
  const double chord = exit_distance(entry, d);
  const glm::dvec3 unscattered = glm::exp(-depth(entry, d, chord, 4000));
  glm::dvec3 once(0), once_square(0);
  const int marches = 60000;
  for (int i = 0; i < marches; ++i) {
    Random march_random(3, static_cast<std::uint64_t>(i), 0);
    const double s = chord * (static_cast<double>(march_random.uniform()) + i) / marches;
    const glm::dvec3 p = entry + s * d;
    const glm::dvec3 away(around(direction, 2 * march_random.uniform() - 1, march_random.uniform()));
    const double phase = static_cast<double>(phase_value(0.5f, static_cast<float>(glm::dot(away, d))));
    const glm::dvec3 tau = depth(entry, d, s, 60) + depth(p, away, exit_distance(p, away), 60);
    const glm::dvec3 value = chord * 4 * M_PI * phase * medium.at(p).sigma_s * glm::exp(-tau);
    once += value;
    once_square += value * value;
  }
  const glm::dvec3 marched = once / static_cast<double>(marches);
  const glm::dvec3 marched_error =
      glm::sqrt((once_square / static_cast<double>(marches) - marched * marched) / static_cast<double>(marches));
  for (int c = 0; c < 3; ++c) {
    std::printf("channel %d: traced %.5f +- %.5f, marched %.5f (unscattered %.5f) +- %.5f\n", c, traced[c],
                traced_error[c], unscattered[c] + marched[c], unscattered[c], marched_error[c]);
    EXPECT_NEAR(traced[c], unscattered[c] + marched[c], 3.5 * std::hypot(traced_error[c], marched_error[c]));
    EXPECT_LT(traced_error[c], 0.01 * traced[c]);
  }
}

// Once scattered light of a half space in diffuse light, isotropic, eta 1: L(mu) = (a/2) (1 - mu ln((1 + mu)/mu)).
TEST(ReferenceTransport, SingleScatteringOfAHalfSpace) {
  World world(slab(30, 60, homogeneous(glm::dvec3(0.6), glm::dvec3(0.4)), 1.0));
  std::uint64_t seed = 500;
  for (double mu : {1.0, 0.5, 0.2}) {
    const auto m = static_cast<float>(mu);
    const glm::vec3 direction(std::sqrt(1 - m * m), 0, -m);
    double first = 0, second = 0;
    const std::uint64_t paths = 200000 * study_factor();
    ++seed;
    for (std::uint64_t i = 0; i < paths; ++i) {
      Random random(seed, i, 0);
      const PathSample s = trace_path(world, glm::vec3(0.01f, 0.02f, 0) - 0.1f * direction, direction, {}, random);
      const double value = static_cast<double>(s.radiance[static_cast<int>(Layer::single)].x);
      first += value;
      second += value * value;
      EXPECT_EQ(s.radiance[static_cast<int>(Layer::surface)].x, 0);
    }
    const double n = static_cast<double>(paths), mean = first / n, error = std::sqrt((second / n - mean * mean) / n);
    const double exact = 0.3 * (1 - mu * std::log((1 + mu) / mu));
    std::printf("| once scattered, mu %.1f | %.5f | %.5f | %.5f | %+.2f %% | %+.1f |\n", mu, mean, error, exact,
                100 * (mean / exact - 1), (mean - exact) / error);
    EXPECT_NEAR(mean, exact, 3 * error);
    EXPECT_LT(error, 0.01 * exact);
  }
}

// A slab of unlike layers transmits diffuse light equally both ways, though it reflects it differently (reciprocity).
TEST(ReferenceTransport, LayeredSlabIsReciprocal) {
  auto layers = [](std::vector<float> values) {
    auto grid = std::make_shared<Grid>();
    grid->size = {1, 1, static_cast<int>(values.size())};
    grid->values = std::move(values);
    return grid;
  };
  Estimate transmitted[2], reflected[2];
  for (int way = 0; way < 2; ++way) {
    Medium medium;
    medium.sigma_t = layers(way ? std::vector<float>{1, 2, 8} : std::vector<float>{8, 2, 1});
    medium.albedo = layers(way ? std::vector<float>{0.99f, 0.9f, 0.5f} : std::vector<float>{0.5f, 0.9f, 0.99f});
    medium.g = 0.3;
    medium.world_to_box = translation({0.5, 0.5, 1}) * scaling({0.05, 0.05, 1});
    World world(slab(1, 20, medium, 1.3));
    transmitted[way] = diffuse(world, 1, true, 300000, 11);
    reflected[way] = diffuse(world, 1, false, 50000, 12);
  }
  const double off = transmitted[0].mean.x - transmitted[1].mean.x,
               error = std::hypot(transmitted[0].error.x, transmitted[1].error.x);
  std::printf("T %.5f and %.5f (+- %.5f), R %.4f and %.4f\n", transmitted[0].mean.x, transmitted[1].mean.x, error,
              reflected[0].mean.x, reflected[1].mean.x);
  EXPECT_LT(std::abs(off), 3 * error);
  EXPECT_LT(error, 0.02 * transmitted[0].mean.x);
  EXPECT_GT(std::abs(reflected[0].mean.x - reflected[1].mean.x), 0.05);
}

// Two slabs that share a face, and a slab inside one of the same stuff, are the one slab.
TEST(ReferenceTransport, TouchingAndNestedObjects) {
  const Medium medium = homogeneous(glm::dvec3(1.5), glm::dvec3(0.1));
  const double exact_paths = 200000;
  const auto paths = static_cast<std::uint64_t>(exact_paths);
  for (double eta : {1.0, 1.5}) {
    World whole(slab(2, 30, medium, eta));
    const Estimate one = diffuse(whole, 2, false, paths, 20);
    Scene scene = slab(2, 30, medium, eta);
    scene.objects.push_back(
        translucent(transformed(box({10, 10, 1}), translation({0, 0, -1})), medium, eta));  // inside
    scene.objects.push_back(translucent(transformed(box({12, 12, 1}), translation({0, 0, -1.5})), medium,
                                        eta));  // overlapping, one face shared
    World nested(scene);
    const Estimate with_nested = diffuse(nested, 2, false, paths, 21);
    std::printf("eta %.1f: one %.5f, nested %.5f +- %.5f\n", eta, one.mean.x, with_nested.mean.x,
                std::hypot(one.error.x, with_nested.error.x));
    EXPECT_NEAR(with_nested.mean.x, one.mean.x, 3 * std::hypot(one.error.x, with_nested.error.x));
    if (eta != 1) continue;
    Scene halves = slab(2, 30, medium, eta);
    halves.objects[0].mesh = transformed(box({30, 30, 1}), translation({0, 0, -0.5}));
    halves.objects.push_back(translucent(transformed(box({30, 30, 1}), translation({0, 0, -1.5})), medium, eta));
    World touching(halves);
    const Estimate two = diffuse(touching, 2, false, paths, 22);
    std::printf("touching %.5f +- %.5f\n", two.mean.x, std::hypot(one.error.x, two.error.x));
    EXPECT_NEAR(two.mean.x, one.mean.x, 3 * std::hypot(one.error.x, two.error.x));
  }
}

// Radiance of a Lambert plate under a parallel square light: albedo * E / pi, E = pi L F, with the form factor of a
// point below the middle of a square of half side a at height h: F = (4/pi) (a/c) atan(a/c) with c = sqrt(a^2 + h^2)
// (J. R. Howell, factor B-4, four corners).
TEST(ReferenceTransport, LambertPlateUnderASquareLight) {
  Scene scene;
  scene.objects.push_back(opaque(quad(20, 20), glm::vec3(0.5f)));
  scene.objects.push_back(emitter(transformed(flipped(quad(2, 2)), translation({0, 1.5, 0})), glm::vec3(3)));
  World world(scene);
  const Estimate e = radiance(world, 100000, 30, [](Random&) { return Ray{{0, 0.5f, 0}, {0, -1, 0}}; });
  const double c = std::sqrt(1 + 2.25), exact = 0.5 * 3 * 4 / M_PI / c * std::atan(1 / c);
  std::printf("plate %.5f +- %.5f, exact %.5f\n", e.mean.x, e.error.x, exact);
  EXPECT_NEAR(e.mean.x, exact, 3 * e.error.x);
  EXPECT_LT(e.error.x, 0.005 * exact);
}

}  // namespace
}  // namespace alabaster

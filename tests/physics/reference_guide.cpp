// Lamps looked for through refracting surfaces (LightGuide) against lamps met by chance: the same pictures, less noise.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "physics/reference_scenes.h"
#include "reference/reference.h"

namespace alabaster {
namespace {
using namespace testing_scenes;

Medium varying_grid(double g) {
  Medium medium = constant_grid(glm::vec3(2, 4, 8), glm::vec3(0.95f, 0.9f, 0.8f), g, 1);
  auto sigma_t = std::make_shared<Grid>(*medium.sigma_t);
  for (std::size_t i = 0; i < sigma_t->values.size(); i += 2) sigma_t->values[i] *= 0.2f;
  medium.sigma_t = sigma_t;
  return medium;
}

/// `object` over a floor, under a large lamp that chance finds well and beside a small two-sided one.
Scene lit(Object object) {
  Scene scene;
  scene.environment.radiance = glm::vec3(0.1f, 0.2f, 0.3f);
  scene.objects.push_back(std::move(object));
  scene.objects.push_back(
      emitter(transformed(flipped(quad(4.5, 4.5)), translation({0.5, 3.2, 0})), glm::vec3(2, 3, 2)));
  scene.objects.push_back(
      emitter(transformed(quad(1.5, 1.5), translation({-1.8, 0, 0}) * rotation({0, 0, 1}, 75)), glm::vec3(1), true));
  scene.objects.push_back(opaque(transformed(quad(6, 6), translation({0, -1.2, 0})), glm::vec3(0.6f)));
  scene.cameras.push_back(looking_at_origin({0.6, 1.5, 2.6}, 0.5f));
  return scene;
}

ReferenceOptions options_for(Guiding guiding, int samples) {
  ReferenceOptions options;
  options.width = options.height = 12;
  options.samples = samples;
  options.guiding = guiding;
  options.seed = guiding == Guiding::always ? 1 : 2;
  return options;
}

void expect_agreement(const Scene& scene, const char* what, int samples, ReferenceOptions layers = {}) {
  Picture pictures[2];
  for (int guided = 0; guided < 2; ++guided) {
    ReferenceOptions options = options_for(guided ? Guiding::always : Guiding::never, guided ? samples / 2 : samples);
    options.multiple = layers.multiple, options.single = layers.single, options.surface = layers.surface;
    pictures[guided] = render_reference(scene, options);
  }
  expect_equal(pictures[1], pictures[0], what, 0.09);  // 0.8 % of the mean
}

TEST(ReferenceGuide, AgreesWithChanceInHomogeneousMedia) {
  for (double eta : {0.9, 1.3, 1.5}) {
    const double g = eta == 1.3 ? 0.0 : 0.6;
    const Medium medium = homogeneous(glm::dvec3(6, 4, 2) / (1 - g), {0.1, 0.2, 0.4}, g);
    char what[60];
    std::snprintf(what, sizeof what, "box, eta %.1f, g %.1f", eta, g);
    expect_agreement(lit(translucent(box({1.6f, 0.6f, 1.6f}), medium, eta)), what, 1600);
    std::snprintf(what, sizeof what, "sphere, eta %.1f, g %.1f", eta, g);
    expect_agreement(lit(translucent(icosphere(2), medium, eta)), what, 1600);
  }
}

TEST(ReferenceGuide, AgreesWithChanceInGrids) {
  expect_agreement(lit(translucent(torus(0.6f, 0.3f, 24, 12), varying_grid(0), 1.5)), "torus, grid, eta 1.5, g 0",
                   2000);
  expect_agreement(lit(translucent(torus(0.6f, 0.3f, 24, 12), varying_grid(0.6), 1.3)), "torus, grid, eta 1.3, g 0.6",
                   2000);
}

// Each layer by itself, so that nothing is booked elsewhere.
TEST(ReferenceGuide, AgreesWithChanceLayerByLayer) {
  const Scene scene =
      lit(translucent(torus(0.6f, 0.3f, 24, 12), homogeneous(glm::dvec3(5), glm::dvec3(0.2), 0.3), 1.4));
  ReferenceOptions layers;
  layers.multiple = layers.surface = false;
  expect_agreement(scene, "single", 6000, layers);
  std::swap(layers.multiple, layers.single);
  expect_agreement(scene, "multiple", 3000, layers);
}

// Objects in objects, a wall and a lamp inside glass, and one mesh that is two lamps.
TEST(ReferenceGuide, AgreesWithChanceInNestedObjects) {
  Scene scene = lit(translucent(icosphere(2), homogeneous(glm::dvec3(0.5), glm::dvec3(0.02)), 1.5));
  scene.objects.push_back(translucent(transformed(box({0.7f, 0.7f, 0.7f}), translation({0.2, 0.1, 0})),
                                      homogeneous(glm::dvec3(8, 6, 4), glm::dvec3(0.1)), 1.2));
  scene.objects.push_back(opaque(transformed(quad(0.5, 0.5), translation({-0.3, -0.5, 0})), glm::vec3(0.5f)));
  scene.objects.push_back(emitter(transformed(quad(0.4f, 0.4f), translation({-0.3, -0.6, 0.2})), glm::vec3(1), true));
  Mesh two = transformed(flipped(quad(1, 1)), translation({2, 1.5, 1}));
  const Mesh second = transformed(flipped(quad(1, 1)), translation({-1, 1.5, 2}));
  for (glm::uvec3 t : second.triangles) two.triangles.push_back(t + static_cast<glm::uint>(two.positions.size()));
  two.positions.insert(two.positions.end(), second.positions.begin(), second.positions.end());
  scene.objects.push_back(emitter(two, glm::vec3(3)));
  expect_agreement(scene, "nested", 4000);
}

double noise(const Picture& picture) { return std::get<double>(picture.attributes.at("noise")); }

// A lamp that fills half a percent of the sphere. Variance of a sample, guided over chance, over seeds: below 1/20; a
// third of that gain is asked for.
TEST(ReferenceGuide, LowersTheNoiseOfSmallLamps) {
  for (const Mesh& mesh : {icosphere(3), torus(0.6f, 0.3f, 24, 12)}) {
    Scene scene;
    scene.objects.push_back(translucent(mesh, homogeneous(glm::dvec3(12), glm::dvec3(0.1)), 1.5));
    scene.objects.push_back(emitter(transformed(flipped(quad(0.75, 0.75)), translation({0, 3, 0})), glm::vec3(20)));
    scene.cameras.push_back(looking_at_origin({0.4, 3, 2}, 0.35f));
    const double by_chance = noise(render_reference(scene, options_for(Guiding::never, 400))),
                 guided = noise(render_reference(scene, options_for(Guiding::always, 400))),
                 automatic = noise(render_reference(scene, options_for(Guiding::automatic, 400)));
    std::printf("noise of 400 samples: by chance %.1f %%, guided %.1f %%, automatic %.1f %%\n", 100 * by_chance,
                100 * guided, 100 * automatic);
    EXPECT_LT(guided * guided, by_chance * by_chance / 7);
    EXPECT_LT(automatic * automatic, by_chance * by_chance / 7);
  }
}

TEST(ReferenceGuide, ThreadsAndInterruptionsDoNotChangeABit) {
  const Scene scene = lit(translucent(icosphere(2), varying_grid(0.3), 1.4));
  ReferenceOptions options = options_for(Guiding::always, 24);
  options.threads = 1;
  const Picture whole = render_reference(scene, options);
  options.threads = 2;
  EXPECT_EQ(render_reference(scene, options).channels, whole.channels);
  options.state_path =
      (std::filesystem::temp_directory_path() / ("alabaster_guide_" + std::to_string(::getpid()) + ".state")).string();
  options.progress = [](const ReferenceProgress&) { return false; };
  EXPECT_LT(std::get<double>(render_reference(scene, options).attributes.at("samplesPerPixel")), 24);
  options.progress = nullptr;
  options.resume = true;
  EXPECT_EQ(render_reference(scene, options).channels, whole.channels);
  options.guiding = Guiding::never;
  options.resume = false;
  EXPECT_NE(render_reference(scene, options).channels.at("R"), whole.channels.at("R"));
}

}  // namespace
}  // namespace alabaster

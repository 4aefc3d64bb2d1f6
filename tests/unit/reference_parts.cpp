// The parts of the path tracer by themselves.
#include <gtest/gtest.h>

#include <cmath>

#include "reference/media.h"
#include "reference/random.h"
#include "reference/world.h"
#include "scene/shapes.h"

namespace alabaster {
namespace {

TEST(ReferencePhase, IsNormalisedWithMeanCosineG) {
  for (float g : {-0.95f, -0.5f, 0.0f, 0.0005f, 0.3f, 0.8f, 0.99f}) {
    double integral = 0, mean = 0;
    const int steps = 400000;
    for (int i = 0; i < steps; ++i) {
      const double angle = M_PI * (i + 0.5) / steps, c = std::cos(angle);  // resolves the peak of either sign
      const double value =
          2 * M_PI * static_cast<double>(phase_value(g, static_cast<float>(c))) * std::sin(angle) * M_PI / steps;
      integral += value;
      mean += c * value;
    }
    EXPECT_NEAR(integral, 1, 2e-4) << g;
    EXPECT_NEAR(mean, static_cast<double>(g), 2e-4) << g;
    double sampled = 0;  // by quadrature over the random number: its mean and, below, its distribution
    for (int i = 0; i < steps; ++i)
      sampled += static_cast<double>(phase_cosine(g, (static_cast<float>(i) + 0.5f) / steps)) / steps;
    EXPECT_NEAR(sampled, static_cast<double>(g), 3e-4) << g;
    for (double u : {0.1, 0.5, 0.9}) {  // share of the phase function below the u-quantile is u
      const double top = static_cast<double>(phase_cosine(g, static_cast<float>(u)));
      double below = 0;
      for (int i = 0; i < steps; ++i) {
        const double c = -1 + (top + 1) * (i + 0.5) / steps;
        below += 2 * M_PI * static_cast<double>(phase_value(g, static_cast<float>(c))) * (top + 1) / steps;
      }
      EXPECT_NEAR(below, u, 5e-4) << g;
    }
  }
}

TEST(ReferenceRandom, StreamsAreUniformAndApart) {
  double mean = 0, square = 0, product = 0;
  const int n = 400000;
  for (int i = 0; i < n; ++i) {  // first numbers of neighbouring streams: what pixels and samples get
    Random a(0, static_cast<std::uint64_t>(i % 640), static_cast<std::uint64_t>(i / 640)),
        b(0, static_cast<std::uint64_t>(i % 640) + 1, static_cast<std::uint64_t>(i / 640));
    const double x = static_cast<double>(a.uniform()) - 0.5, y = static_cast<double>(b.uniform()) - 0.5;
    mean += x / n;
    square += x * x / n;
    product += x * y / n;
  }
  EXPECT_NEAR(mean, 0, 4 * std::sqrt(1.0 / 12 / n));
  EXPECT_NEAR(square, 1.0 / 12, 4 * std::sqrt(1.0 / 180 / n));
  EXPECT_NEAR(product, 0, 4 / 12.0 / std::sqrt(n));
  double longest = 0;
  Random r(3, 1, 4);
  for (int i = 0; i < n; ++i) {
    const double e = static_cast<double>(r.exponential());
    ASSERT_GT(e, 0);
    longest = std::max(longest, e);
  }
  EXPECT_TRUE(std::isfinite(longest));
}

TEST(ReferenceMedia, GridIsSampledAsTheSceneDoes) {
  auto sigma_t = std::make_shared<Grid>(), albedo = std::make_shared<Grid>();
  Random random(1, 2, 3);
  for (bool trilinear : {true, false}) {
    sigma_t = std::make_shared<Grid>();
    albedo = std::make_shared<Grid>();
    sigma_t->size = {7, 40, 3};
    albedo->size = {2, 2, 5};
    sigma_t->channels = 3;
    sigma_t->trilinear = albedo->trilinear = trilinear;
    for (int i = 0; i < 7 * 40 * 3 * 3; ++i) sigma_t->values.push_back(random.uniform());
    for (int i = 0; i < 20; ++i) albedo->values.push_back(random.uniform());
    Medium medium;
    medium.sigma_t = sigma_t;
    medium.albedo = albedo;
    medium.scale = 3;
    medium.world_to_box = scaling({0.5, 0.7, 0.9}) * rotation({1, 0, 2}, 30);
    const FlatMedium flat(medium);
    for (int i = 0; i < 2000; ++i) {
      const glm::vec3 p = 4.0f * (glm::vec3(random.uniform(), random.uniform(), random.uniform()) - 0.5f);
      const Coefficients exact = medium.at(glm::dvec3(p));
      const Optics optics = flat.at(p);
      const glm::dvec3 t = exact.sigma_s + exact.sigma_a;
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(optics.sigma_t[c], t[c], 1e-4);
        EXPECT_NEAR(optics.sigma_s[c], exact.sigma_s[c], 1e-4);
      }
    }
  }
}

// Every sigma_t along a ray is below the local majorant, and the candidates' number is the majorants' integral.
TEST(ReferenceMedia, MajorantsBoundTheMedium) {
  auto sigma_t = std::make_shared<Grid>();
  sigma_t->size = {50, 9, 33};
  Random random(1, 1, 1);
  for (int i = 0; i < 50 * 9 * 33; ++i)
    sigma_t->values.push_back(random.uniform() < 0.5f ? 0.0f : 100 * random.uniform() * random.uniform());
  Medium medium;
  medium.sigma_t = sigma_t;
  medium.world_to_box = translation(glm::dvec3(0.5)) * rotation({3, 1, 2}, 25);
  const FlatMedium flat(medium);
  long candidates_met = 0;
  for (int ray = 0; ray < 3000; ++ray) {
    const glm::vec3 origin = 2.0f * (glm::vec3(random.uniform(), random.uniform(), random.uniform()) - 0.5f);
    const glm::vec3 direction = around({0, 0, 1}, 2 * random.uniform() - 1, random.uniform());
    Candidates candidates(flat, origin, direction, random);
    float before = 0;
    while (candidates.next(1.5f)) {
      ++candidates_met;
      EXPECT_GE(candidates.distance(), before);
      before = candidates.distance();
      EXPECT_LE(before, 1.5f);
      EXPECT_LE(flat.at(origin + before * direction).sigma_t.x, candidates.majorant() * 1.0001f);
    }
  }
  EXPECT_GT(candidates_met, 10000);
}

TEST(ReferenceWorld, ClearanceIsALowerBound) {
  Scene scene;
  Object ring;
  ring.role = Role::translucent;
  ring.mesh = torus(1, 0.5f, 40, 20);
  ring.medium.homogeneous = {glm::dvec3(100), glm::dvec3(0)};
  scene.objects.push_back(ring);
  const World world(scene);
  Random random(1, 1, 1);
  int useful = 0, inside_count = 0;
  for (int i = 0; i < 20000; ++i) {
    const glm::vec3 p = glm::vec3(3, 1, 3) * (glm::vec3(random.uniform(), random.uniform(), random.uniform()) - 0.5f);
    const float from_axis = std::hypot(std::hypot(p.x, p.z) - 1, p.y);  // of the smooth torus; the mesh lies inside it
    if (from_axis > 0.47f) continue;
    ++inside_count;
    const float bound = world.clearance(0, p);
    EXPECT_LE(bound, 0.5f - from_axis + 1e-5f);
    useful += bound > 0.5f * (0.5f - from_axis) - 0.02f;
    // No ray meets anything within the bound.
    Hit hit;
    Inside inside;
    inside.push(0);
    const glm::vec3 direction = around({0, 0, 1}, 2 * random.uniform() - 1, random.uniform());
    EXPECT_FALSE(bound > 0 && world.next_surface(p, direction, bound, inside, {}, hit));
  }
  EXPECT_GT(useful, 0.7 * inside_count);
  EXPECT_TRUE(world.inside_at({1, 0, 0}).holds(0));
  EXPECT_TRUE(world.inside_at({0, 0, 0}).empty());
  EXPECT_TRUE(world.inside_at({5, 0, 0}).empty());
}

}  // namespace
}  // namespace alabaster

// The path tracer against published and exact values of plane-parallel transport.
#include <gtest/gtest.h>

#include <string>

#include "physics/reference_scenes.h"

namespace alabaster {
namespace {
using namespace testing_scenes;

void expect_within(const char* what, const Estimate& e, double truth) {
  const double off = e.mean.x / truth - 1, error = e.error.x / truth;
  // A row of a table: measured, its standard error, exact, deviation in percent and in standard errors.
  std::printf("| %-36s | %.5f | %.5f | %.5f | %+.2f %% | %+.1f |\n", what, e.mean.x, e.error.x, truth, 100 * off,
              off / error);
  EXPECT_LT(error, 0.01) << what << ": too few paths to say anything";
  // The tables are rounded to their last digit: half of it is theirs.
  EXPECT_NEAR(e.mean.x, truth, 3 * e.error.x + 5e-5) << what;
  EXPECT_LT(std::abs(off), study_factor() > 1 ? 0.003 : 0.03) << what;
}

std::string label(const char* pattern, double a, double b, const char* c = "") {
  char text[100];
  std::snprintf(text, sizeof text, pattern, a, b, c);
  return text;
}

// H. C. van de Hulst, "Multiple Light Scattering", 1980, vol. 2, table 35: the standard test of tissue Monte Carlo
// (Wang, Jacques, Zheng 1995): eta 1, mu_a 10/cm, mu_s 90/cm, g 0.75, 0.02 cm.
TEST(ReferenceSlabs, VanDeHulst) {
  World world(slab(0.02, 1.0, homogeneous(glm::dvec3(90), glm::dvec3(10), 0.75), 1.0));
  expect_within("van de Hulst R", normal(world, 0.02, false, 300000 * study_factor(), 3), 0.09739);
  expect_within("van de Hulst T", normal(world, 0.02, true, 40000 * study_factor(), 4), 0.66096);
}

// R. G. Giovanelli, "Reflection by semi-infinite diffusers", Optica Acta 2, 1955: eta 1.5, a = 0.9, g = 0, normal
// incidence.
TEST(ReferenceSlabs, Giovanelli) {
  World world(slab(0.5, 2.0, homogeneous(glm::dvec3(90), glm::dvec3(10)), 1.5));
  expect_within("Giovanelli R", normal(world, 0.5, false, 80000 * study_factor(), 5), 0.2600);
}

// Conservative slabs (a = 1, g = 0) in diffuse light. Exact: at eta 1 from Peierls's integral equation, solved with a
// conserving Galerkin scheme and extrapolated (T of the thicker two is (4/3)/(b + 2 * 0.710446), Hopf's constant); at
// eta 1.4 by adding-doubling.
TEST(ReferenceSlabs, ConservativeInDiffuseLight) {
  std::uint64_t seed = 100;
  struct Row {
    double eta, thickness, reflected, transmitted;
  };
  for (const Row& row : {Row{1.0, 2, .60994, .39006}, Row{1.0, 8, .85847, .14153}, Row{1.0, 32, .96010, .03990},
                         Row{1.4, 2, .5371, .4629}, Row{1.4, 8, .7770, .2230}, Row{1.4, 32, .9268, .0732}}) {
    World world(slab(row.thickness, 12 * row.thickness, homogeneous(glm::dvec3(1), glm::dvec3(0)), row.eta));
    const auto paths = static_cast<std::uint64_t>(row.thickness > 20 ? 25000 : 50000) * study_factor();
    expect_within(label("eta %.1f thickness %2.0f diffuse %s", row.eta, row.thickness, "R").c_str(),
                  diffuse(world, row.thickness, false, paths, seed++), row.reflected);
    expect_within(label("eta %.1f thickness %2.0f diffuse %s", row.eta, row.thickness, "T").c_str(),
                  diffuse(world, row.thickness, true, row.thickness > 20 ? 10 * paths : 2 * paths, seed++),
                  row.transmitted);
  }
}

// Half spaces, g = 0, normal incidence, with the surface's own reflection; exact by adding-doubling.
TEST(ReferenceSlabs, HalfSpaces) {
  std::uint64_t seed = 200;
  struct Row {
    double eta, albedo, reflected;
  };
  for (const Row& row :
       {Row{1.0, .9, .41495}, Row{1.0, .99, .75272}, Row{1.0, .999, .91285}, Row{1.3, .9, .3028}, Row{1.3, .99, .6624},
        Row{1.3, .999, .8738}, Row{1.5, .9, .25993}, Row{1.5, .99, .6020}, Row{1.5, .999, .84147}}) {
    const double depth = 6 / std::sqrt(3 * (1 - row.albedo));  // six diffusion lengths: exp(-12) comes back from there
    World world(slab(depth, 4 * depth, homogeneous(glm::dvec3(row.albedo), glm::dvec3(1 - row.albedo)), row.eta));
    expect_within(label("eta %.1f albedo %.3f half space", row.eta, row.albedo).c_str(),
                  normal(world, depth, false, 50000 * study_factor(), seed++), row.reflected);
  }
}

// The same under a shining ceiling in place of the environment: an area light, seen through the surface
// (LightGuide).
TEST(ReferenceSlabs, HalfSpacesUnderACeiling) {
  std::uint64_t seed = 300;
  struct Row {
    double eta, albedo, g, reflected;
  };
  for (const Row& row : {Row{1.0, .99, 0, .75272}, Row{1.3, .99, 0, .6624}, Row{1.5, .9, 0, .25993},
                         Row{1.5, .99, 0, .6020}, Row{1.5, .99, .9, .26048}}) {
    const double depth = 6 / std::sqrt(3 * (1 - row.albedo) * (1 - row.g * row.albedo)), width = 4 * depth;
    Scene scene = slab(depth, width, homogeneous(glm::dvec3(row.albedo), glm::dvec3(1 - row.albedo), row.g), row.eta);
    scene.environment.radiance = glm::vec3(0);
    const float size = static_cast<float>(20 * width);
    Mesh ceiling = transformed(flipped(quad(size, size)), translation({0, 0.02 * depth, 0}));
    scene.objects.push_back(emitter(transformed(ceiling, rotation({1, 0, 0}, 90)), glm::vec3(1)));
    World world(scene, Guiding::always);
    expect_within(
        label(row.g > 0 ? "ceiling: g 0.9 eta %.1f albedo %.2f" : "ceiling: eta %.1f albedo %.2f", row.eta, row.albedo)
            .c_str(),
        normal(world, depth, false, 20000 * study_factor(), seed++), row.reflected);
  }
}

// The same with forward scattering; exact by adding-doubling.
TEST(ReferenceSlabs, HalfSpacesForwardScattering) {
  std::uint64_t seed = 400;
  struct Row {
    double eta, albedo, reflected;
  };
  for (const Row& row : {Row{1.0, .9, .06859}, Row{1.0, .99, .39955}, Row{1.0, .999, .74596}, Row{1.5, .99, .26048},
                         Row{1.5, .999, .60247}}) {
    const double depth = 6 / std::sqrt(3 * (1 - row.albedo) * (1 - 0.9 * row.albedo));
    World world(slab(depth, 4 * depth, homogeneous(glm::dvec3(row.albedo), glm::dvec3(1 - row.albedo), 0.9), row.eta));
    expect_within(label("g 0.9 eta %.1f albedo %.3f half space", row.eta, row.albedo).c_str(),
                  normal(world, depth, false, (row.albedo < .95 ? 120000 : 40000) * study_factor(), seed++),
                  row.reflected);
  }
}

}  // namespace
}  // namespace alabaster

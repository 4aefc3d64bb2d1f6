// Single scattering as a layer of its own in whole renders: against the path tracer's layer, in the energy balance, in
// the furnace; what it adds and what it takes.
#include <filesystem>

#include "compare/compare.h"
#include "reference/reference.h"
#include "support/device.h"
#include "support/furnace.h"

namespace alabaster {
namespace {

const std::set<Component> all_components{Component::multiple, Component::single, Component::surface};

class SinglePictures : public GpuTest {
 protected:
  RenderResult render(const Scene& scene, std::optional<std::set<Component>> components, Transport transport,
                      glm::ivec2 size, int grid = 32) {
    Request request;
    request.grid = grid;
    request.size = size;
    request.transport = transport;
    request.components = std::move(components);
    request.light_samples = 16;
    const RenderResult r = render_scene(context, scene, make_plan(scene, request, context.info().heap_bytes));
    for (const ObjectReport& object : r.objects) {
      EXPECT_TRUE(object.solver.converged);
      EXPECT_LE(object.energy.imbalance(), 1e-5);
    }
    return r;
  }

  static Scene lit_scene(const Mesh& mesh, const Medium& medium, double eta) {
    Scene scene;
    scene.path = "test";
    Object object;
    object.name = "object";
    object.role = Role::translucent;
    object.mesh = mesh;
    object.medium = medium;
    object.eta = eta;
    Object lamp;
    lamp.name = "lamp";
    lamp.role = Role::emissive;
    lamp.mesh = transformed(quad(2, 2), glm::dmat4(look_at({4, 5, 3}, {0, 0, 0})) * rotation({1, 0, 0}, -90));
    lamp.radiance = glm::vec3(10);
    scene.objects = {object, lamp};
    Camera camera;
    camera.to_world = glm::mat4(look_at({0.5, 2, 5}, {0, 0, 0}));
    camera.y_fov = 0.5f;
    scene.cameras = {camera};
    return scene;
  }

  static Medium medium_of(double sigma_t, double albedo, double g = 0) {
    Medium medium;
    medium.g = g;
    medium.homogeneous = {glm::dvec3(sigma_t * albedo), glm::dvec3(sigma_t * (1 - albedo))};
    return medium;
  }

  static double mean_of(const Picture& picture, const std::string& layer) {
    const std::vector<float>& plane = picture.channels.at(layer + "G");
    double sum = 0;
    for (float v : plane) sum += v;
    return sum / double(plane.size());
  }

  /// The layer against the path tracer's.
  void expect_layer(const char* what, const Scene& scene, Transport transport, double bias, double error) {
    const glm::ivec2 size(40, 30);
    ReferenceOptions options;
    options.width = size.x, options.height = size.y;
    options.samples = 96;
    options.multiple = options.surface = false;
    Picture truth = render_reference(scene, options);
    Picture test = render(scene, all_components, transport, size).shaded.picture;
    for (const char* c : {"R", "G", "B"}) test.plane(c) = test.plane(std::string("single.") + c);
    const Comparison found = compare(test, truth);
    std::printf("%-24s %s: bias %+.2f %% (%+.1f s.e.), error %.2f %%, noise %.2f %%\n", what, name_of(transport),
                100 * found.all.bias, found.z->bias_z, 100 * found.z->corrected_rmse, 100 * found.z->noise);
    EXPECT_LT(std::abs(found.all.bias), bias) << what;
    EXPECT_LT(found.z->corrected_rmse, error) << what;
  }
};

TEST_F(SinglePictures, ReportEqualsThePathTracer) {
  const Mesh plate = box({2, 0.3f, 2}, 8);
  expect_layer("plate, eta 1", lit_scene(plate, medium_of(40, 0.95), 1), Transport::report, 0.01, 0.02);
  expect_layer("plate, eta 1, g 0.7", lit_scene(plate, medium_of(80, 0.95, 0.7), 1), Transport::report, 0.02, 0.03);
  expect_layer("ball, eta 1", lit_scene(icosphere(4), medium_of(20, 0.95), 1), Transport::report, 0.02, 0.04);
  expect_layer("ball, eta 1.4", lit_scene(icosphere(4), medium_of(20, 0.8), 1.4), Transport::report, 0.04, 0.1);
}

TEST_F(SinglePictures, GatherEqualsThePathTracer) {
  expect_layer("plate, eta 1", lit_scene(box({2, 0.3f, 2}, 8), medium_of(40, 0.95), 1), Transport::gather, 0.03, 0.07);
  expect_layer("ball, eta 1", lit_scene(icosphere(4), medium_of(20, 0.95), 1), Transport::gather, 0.03, 0.07);
}

// Steep light does not enter a medium of a lower index, nor come from it: the closure's averages leave it out.
TEST_F(SinglePictures, GatherOfALowerIndex) {
  for (double eta : {0.5, 0.8}) {
    const Scene scene = lit_scene(icosphere(4), medium_of(20, 0.99), eta);
    const Picture gather = render(scene, {}, Transport::gather, {40, 30}).shaded.picture,
                  report = render(scene, {}, Transport::report, {40, 30}).shaded.picture;
    for (float v : gather.channels.at("G")) ASSERT_TRUE(std::isfinite(v)) << eta;
    EXPECT_NEAR(mean_of(gather, "") / mean_of(report, ""), 1, 0.1) << eta;
  }
}

// A ray that passes below a lit surface meets its light where it neither starts nor ends there, too: bumps of a few
// cells, lit from behind, against rays to the lamp, which hardly depend on the grid.
TEST_F(SinglePictures, GatherSeesLightThatItPasses) {
  Mesh bumps = icosphere(5);
  for (glm::vec3& p : bumps.positions) p *= 1 + 0.1f * std::sin(14 * p.x) * std::sin(14 * p.y) * std::sin(14 * p.z);
  Scene scene = lit_scene(bumps, medium_of(10, 0.95), 1.3);
  scene.objects[1].mesh =
      transformed(quad(2, 2), glm::dmat4(look_at({-3, 4, -5}, {0, 0, 0})) * rotation({1, 0, 0}, -90));
  const Picture rays = render(scene, all_components, Transport::report, {80, 60}, 64).shaded.picture,
                gather = render(scene, all_components, Transport::gather, {80, 60}, 32).shaded.picture;
  double square = 0, all = 0, pixels = 0;
  const auto &exact = rays.channels.at("single.G"), &found = gather.channels.at("single.G");
  for (std::size_t i = 0; i < exact.size(); ++i) {
    if (rays.channels.at("object.Y")[i] < 1) continue;
    square += std::pow(double(found[i]) - exact[i], 2), all += exact[i], ++pixels;
  }
  const double bias = mean_of(gather, "single.") / mean_of(rays, "single.") - 1,
               error = std::sqrt(square / pixels) / (all / pixels);
  std::printf("single by the gather: bias %+.3f, error %.3f of rays\n", bias, error);
  EXPECT_LT(std::abs(bias), 0.05);
  EXPECT_LT(error, 0.65);
}

// Layers add up to R, G, B; what is not computed by itself is in `multiple`; and for the report a half space, which a
// plate of 40 mean free paths nearly is, stays as bright as it was.
TEST_F(SinglePictures, LayersAddUp) {
  const Scene scene = lit_scene(box({2, 1, 2}, 8), medium_of(40, 0.95), 1.3);
  for (Transport transport : {Transport::report, Transport::directional, Transport::beam, Transport::gather}) {
    const Picture apart = render(scene, all_components, transport, {32, 24}).shaded.picture,
                  together =
                      render(scene, {{Component::multiple, Component::surface}}, transport, {32, 24}).shaded.picture;
    double worst = 0;
    for (std::size_t i = 0; i < apart.channels.at("G").size(); ++i)
      worst = std::max<double>(worst, std::abs(apart.channels.at("G")[i] - apart.channels.at("multiple.G")[i] -
                                               apart.channels.at("single.G")[i] - apart.channels.at("surface.G")[i]));
    EXPECT_LT(worst, 1e-5);
    EXPECT_EQ(together.channels.count("single.G"), 0u);
    const double sum = mean_of(apart, "") / mean_of(together, "");
    std::printf("%s: single %.4f of %.4f, sum %.4f of the sum without\n", name_of(transport), mean_of(apart, "single."),
                mean_of(apart, ""), sum);
    EXPECT_GT(mean_of(apart, "single."), 0.02 * mean_of(apart, ""));
    EXPECT_NEAR(sum, 1, transport == Transport::gather ? 1e-5 : 0.03);
  }
}

// Light that another surface has sent was scattered before: the layer of a concave object is the same without it. At
// eta 1 no surface mirrors, which would be single scattering.
TEST_F(SinglePictures, TheGathersLayerHasNoLightThatSurfacesSent) {
  Scene scene = lit_scene(torus(1, 0.4f, 48, 24), medium_of(20, 0.99), 1);
  scene.objects[1].mesh =
      transformed(quad(2, 2), glm::dmat4(look_at({0, 6, 0.5}, {0, 0, 0})) * rotation({1, 0, 0}, -90));
  const Picture with = render(scene, all_components, Transport::gather, {48, 36}).shaded.picture;
  Request request;
  request.grid = 32, request.size = {48, 36}, request.light_samples = 16;
  request.transport = Transport::gather, request.components = all_components;
  request.interreflections = 0;
  const Picture without =
      render_scene(context, scene, make_plan(scene, request, context.info().heap_bytes)).shaded.picture;
  double worst = 0;
  for (std::size_t i = 0; i < with.channels.at("single.G").size(); ++i)
    worst = std::max<double>(worst, std::abs(with.channels.at("single.G")[i] - without.channels.at("single.G")[i]));
  const double single = mean_of(with, "single.") / mean_of(without, "single.") - 1,
               multiple = mean_of(with, "multiple.") / mean_of(without, "multiple.") - 1,
               brightest =
                   *std::max_element(without.channels.at("single.G").begin(), without.channels.at("single.G").end());
  std::printf("light between surfaces changes single by %+.4f, the rest by %+.4f; a pixel of single by %.4f at most\n",
              single, multiple, worst / brightest);
  EXPECT_GT(multiple, 0.02);
  EXPECT_LT(std::abs(single), 0.003);
  EXPECT_LT(worst, 0.05 * brightest);
}

// What single scattering carries out is missing from the rest, no more and no less.
TEST_F(SinglePictures, TheFurnaceHolds) {
  for (Transport transport : {Transport::report, Transport::beam})
    for (double eta : {1.0, 1.5}) {
      const test::FurnaceResult r = test::furnace_figures(
          render(test::furnace_scene(icosphere(4), eta), all_components, transport, {60, 45}).shaded.picture);
      std::printf("%s eta %.1f: mean %.4f, worst pixel %.4f off\n", name_of(transport), eta, r.mean, r.worst);
      EXPECT_NEAR(r.mean, 1, 0.01);
    }
}

// Light that leaves after one scattering enters a concave object again.
TEST_F(SinglePictures, TheFurnaceHoldsOnATorus) {
  const test::FurnaceResult r = test::furnace_figures(
      render(test::furnace_scene(torus(1, 0.4f, 48, 24), 1), all_components, Transport::report, {48, 36}, 24)
          .shaded.picture);
  std::printf("torus: mean %.4f, worst pixel %.4f off\n", r.mean, r.worst);
  EXPECT_NEAR(r.mean, 1, 0.01);
}

TEST_F(SinglePictures, TheFurnaceHoldsWithForwardScattering) {
  const test::FurnaceResult r = test::furnace_figures(
      render(test::furnace_scene(icosphere(4), 1.3, 0.6), all_components, Transport::report, {60, 45}).shaded.picture);
  std::printf("g 0.6: mean %.4f, worst pixel %.4f off\n", r.mean, r.worst);
  EXPECT_NEAR(r.mean, 1, 0.01);
}

// A grid whose cells all have the same values, and the medium it stands for.
TEST_F(SinglePictures, HeterogeneousEqualsConstant) {
  Medium grid;
  auto density = std::make_shared<Grid>(), albedo = std::make_shared<Grid>();
  density->size = albedo->size = {2, 2, 2};
  density->values.assign(8, 20.0f);
  albedo->values.assign(8, 0.9f);
  grid.sigma_t = density, grid.albedo = albedo;
  grid.world_to_box = translation({0.5, 0.5, 0.5}) * scaling({0.4, 0.4, 0.4});
  const Picture
      marched = render(lit_scene(icosphere(4), grid, 1.3), all_components, Transport::report, {32, 24}).shaded.picture,
      constant = render(lit_scene(icosphere(4), medium_of(20, 0.9), 1.3), all_components, Transport::report, {32, 24})
                     .shaded.picture;
  double square = 0, norm = 0;
  for (std::size_t i = 0; i < constant.channels.at("single.G").size(); ++i) {
    const double a = marched.channels.at("single.G")[i], b = constant.channels.at("single.G")[i];
    square += (a - b) * (a - b), norm += b * b;
  }
  std::printf("marched against constant: %.4f\n", std::sqrt(square / norm));
  EXPECT_LT(std::sqrt(square / norm), 0.02);  // places: 8 and 4
  EXPECT_NEAR(mean_of(marched, "multiple.") / mean_of(constant, "multiple."), 1,
              3e-3);  // what is taken differs as much
}

}  // namespace
}  // namespace alabaster

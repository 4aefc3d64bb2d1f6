// Whole pictures on lavapipe against small EXRs of our own, committed beside this file. A change that moves a picture
// on purpose renders them anew: ALABASTER_UPDATE_IMAGES=1 build/release/bin/test_image; then look at them before
// committing.
#include <gtest/gtest.h>

#include <cstdlib>

#include "compare/compare.h"
#include "pipeline/render.h"
#include "scene/shapes.h"
#include "support/device.h"

namespace alabaster {
namespace {

Object solid(const std::string& name, Mesh mesh, glm::dvec3 sigma_s, glm::dvec3 sigma_a, double eta) {
  Object object;
  object.name = name;
  object.role = Role::translucent;
  object.mesh = std::move(mesh);
  object.medium.homogeneous = {sigma_s, sigma_a};
  object.eta = eta;
  return object;
}

/// Ground at y = 0, a lamp up left in front, a camera that looks at the origin from the front.
Scene studio() {
  Scene scene;
  scene.path = "studio";
  Object ground;
  ground.name = "ground";
  ground.mesh = quad(1, 1);
  ground.albedo = glm::vec3(0.4f, 0.45f, 0.5f);
  Object lamp;
  lamp.name = "lamp";
  lamp.role = Role::emissive;
  lamp.mesh =
      transformed(quad(0.1f, 0.1f), glm::dmat4(look_at({-0.15, 0.25, 0.15}, {0, 0.02, 0})) * rotation({1, 0, 0}, -90));
  lamp.radiance = {30, 28, 25};
  scene.objects = {ground, lamp};
  Camera camera;
  camera.name = "front";
  camera.to_world = look_at({0.02, 0.12, 0.25}, {0, 0.025, 0});
  camera.y_fov = 0.6f;
  scene.cameras.push_back(camera);
  return scene;
}

class Regression : public GpuTest {
 protected:
  void expect_same(const std::string& name, const Scene& scene, Request request = {}) {
    request.size = {96, 72};
    request.grid = 24;
    request.light_samples = 8;
    request.exchange_directions = 32;
    Plan plan = make_plan(scene, request, context.info().heap_bytes);
    plan.pixel_samples = 4;  // as the pictures were made
    const RenderResult result = render_scene(context, scene, plan);
    const std::string path = std::string(ALABASTER_TESTS) + "/image/" + name + ".exr";
    Picture picture;
    picture.width = 96, picture.height = 72;
    for (const char* channel :
         {"R", "G", "B", "multiple.R", "multiple.G", "multiple.B", "fluence.G", "gamma_s.G", "Z", "object.Y"})
      picture.channels[channel] = result.shaded.picture.channels.at(channel);
    if (std::getenv("ALABASTER_UPDATE_IMAGES")) {
      write_exr(picture, path, true);
      write_png(picture, ::testing::TempDir() + "/" + name + ".png");
    }
    const Picture known = read_exr(path);
    for (const char* layer : {"sum", "multiple"}) {
      CompareOptions options;
      options.layer = layer;
      const Comparison c = compare(picture, known, options);
      EXPECT_GT(c.pixels, 300u);
      EXPECT_LE(c.all.relative_rmse, 1e-3) << name << " " << layer;  // half precision alone is 3e-4
      EXPECT_LE(c.all.worst, 2e-2) << name << " " << layer;
    }
    for (const char* channel : {"fluence.G", "gamma_s.G", "Z", "object.Y"}) {
      double error = 0, size = 0;
      for (std::size_t i = 0; i < picture.channels[channel].size(); ++i) {
        error += std::abs(picture.channels[channel][i] - known.channels.at(channel)[i]);
        size += std::abs(known.channels.at(channel)[i]);
      }
      EXPECT_LE(error, 1e-3 * size) << name << " " << channel;
    }
  }
};

TEST_F(Regression, Torus) {
  Scene scene = studio();
  scene.objects.push_back(
      solid("torus", transformed(torus(0.04f, 0.018f, 64, 32), translation({0, 0.04, 0}) * rotation({1, 0, 0}, 60)),
            {400, 500, 600}, {1, 3, 8}, 1.4));
  expect_same("torus", scene);
}

TEST_F(Regression, TwoObjectsOneOfThemVeined) {
  Scene scene = studio();
  scene.objects.push_back(solid("ball", transformed(icosphere(4, 0.025f), translation({-0.04, 0.025, 0.02})),
                                {800, 800, 800}, {0.5, 0.5, 0.5}, 1.3));
  Object box_object = solid(
      "block", transformed(box({0.05f, 0.06f, 0.04f}), translation({0.04, 0.031, -0.01}) * rotation({0, 1, 0}, 25)), {},
      {}, 1.5);
  Grid sigma_t{{4, 4, 4}, 1, {}}, albedo{{4, 4, 4}, 3, {}};
  for (int i = 0; i < 64; ++i) {
    sigma_t.values.push_back(i % 3 ? 900.f : 300.f);
    for (float a : {0.999f, i % 3 ? 0.995f : 0.9f, i % 5 ? 0.99f : 0.95f}) albedo.values.push_back(a);
  }
  box_object.medium.sigma_t = std::make_shared<Grid>(sigma_t);
  box_object.medium.albedo = std::make_shared<Grid>(albedo);
  box_object.medium.world_to_box = glm::inverse(translation({0, 0, -0.05}) * scaling(glm::dvec3(0.08)));
  scene.objects.push_back(box_object);
  expect_same("two-objects", scene);
}

TEST_F(Regression, SphereInUniformLightAsPrinted) {
  Scene scene = studio();
  scene.objects.pop_back();
  scene.environment.radiance = {1, 0.9f, 0.8f};
  scene.objects.push_back(
      solid("sphere", transformed(icosphere(4, 0.035f), translation({0, 0.04, 0})), {300, 300, 300}, {0, 2, 20}, 1.3));
  Request request;
  request.transport = Transport::as_printed;
  expect_same("sphere-as-printed", scene, request);
}

}  // namespace
}  // namespace alabaster

// What smooth and rough surfaces mirror, against the path tracer's `surface` layer.
#include <filesystem>

#include "scene/demo_scenes.h"
#include "support/furnace.h"
#include "support/mirror.h"

namespace alabaster {
namespace {

class Mirror : public GpuTest {
 protected:
  static Scene demo(const std::string& name) {
    Scene scene = demo_scene(name, ALABASTER_MESHES);
    blacken(scene);
    return scene;
  }

  /// Bias below four standard errors and the error that is not noise below `most`, over the object's pixels.
  void expect_equal(const Scene& scene, double most, glm::ivec2 size = {80, 60}, int samples = 256) {
    const Frame frame{size, 25}, fine{2 * size, 25};  // of ours so many samples that lamps' edges are no matter
    const Comparison c =
        compare(coarser(mirrored_picture(context, scene, fine), 2), mirrored_reference(scene, frame, samples));
    ASSERT_GT(c.pixels, 150u);
    ASSERT_TRUE(c.z);
    std::printf(
        "mean %.5f, reference %.5f, bias %.2f %% (%.1f standard errors), RMSE %.1f %%, without noise %.1f %%, |z| > 3 "
        "in %.2f %%\n",
        c.all.mean_test, c.all.mean_reference, 100 * c.all.bias, c.z->bias_z, 100 * c.all.relative_rmse,
        100 * c.z->corrected_rmse, 100 * c.z->rejected);
    EXPECT_LT(std::abs(c.z->bias_z), 4);
    EXPECT_LT(c.z->corrected_rmse, most);
  }
};

TEST_F(Mirror, SphereEqualsReference) { expect_equal(demo("sphere-marble"), 0.1); }
TEST_F(Mirror, TorusEqualsReference) { expect_equal(demo("torus-wax"), 0.1); }

TEST_F(Mirror, BunnyEqualsReference) {
  if (!std::filesystem::exists(std::string(ALABASTER_MESHES) + "/bunny00.off")) GTEST_SKIP() << "no scanned meshes";
  expect_equal(demo("bunny-marble"), 0.1);
}

// Lamps alone: where a path tracer meets a diffuse ground through a rough mirror its noise has tails that no variance
// tells.
TEST_F(Mirror, RoughSurfacesEqualReference) {
  for (auto [name, roughness] : {std::pair("sphere-marble", 0.2), {"torus-wax", 0.5}, {"sphere-marble", 1.0}}) {
    Scene scene = demo(name);
    scene.objects.pop_back();  // the ground
    for (Object& object : scene.objects) object.roughness = roughness;
    std::printf("%s, roughness %.1f: ", name, roughness);
    expect_equal(scene, 0.08, {40, 30}, 2048);
  }
}

// What blocks the environment shows in it.
TEST_F(Mirror, TorusInTheEnvironmentEqualsReference) {
  Scene scene = demo("torus-furnace");
  expect_equal(scene, 0.05);
  scene.objects.front().roughness = 0.5;
  expect_equal(scene, 0.05);
}

// Reflection and transmission make one at every roughness: of the path tracer this tests the lobe and its sampling ...
TEST_F(Mirror, RoughFurnaceOfThePathTracer) {
  for (double roughness : {0.0, 0.2, 0.6, 1.0}) {
    Scene scene = test::furnace_scene(icosphere(4), 1.5);
    scene.objects.front().medium.homogeneous.sigma_s = glm::dvec3(3);
    scene.objects.front().roughness = roughness;
    const test::FurnaceResult r = test::furnace_figures(mirrored_reference(scene, {{32, 24}, 1}, 256));
    std::printf("reference, roughness %.1f: mean %.4f\n", roughness, r.mean);
    EXPECT_NEAR(r.mean, 1, 3e-3);
  }
}

// ... and of the renderer that with a convex object nothing is lost on the way.
TEST_F(Mirror, RoughFurnaceOfTheRenderer) {
  for (double roughness : {0.2, 0.6, 1.0}) {
    Scene scene = test::furnace_scene(icosphere(5), 1.5);
    scene.objects.front().roughness = roughness;
    Request request;
    request.grid = 32;
    request.size = {80, 60};
    const RenderResult result = render_scene(context, scene, make_plan(scene, request, context.info().heap_bytes));
    const test::FurnaceResult r = test::furnace_figures(result.shaded.picture);
    std::printf("roughness %.1f: mean %.5f, worst pixel %.5f off\n", roughness, r.mean, r.worst);
    EXPECT_NEAR(r.mean, 1, 1e-3);
    EXPECT_LE(r.worst, 5e-3);
  }
}

TEST_F(Mirror, MirroringsBeyondTheSecondCarryLittle) {
  const Scene scene = demo("torus-wax");
  double mean[4];
  for (int orders : {1, 2, 3}) {
    const Picture p = mirrored_picture(context, scene, {{80, 60}, 25}, orders);
    mean[orders] = 0;
    for (std::size_t i = 0; i < p.channels.at("G").size(); ++i)
      if (p.channels.at("object.Y")[i] > 0.999f) mean[orders] += p.channels.at("G")[i];
  }
  std::printf("of all that is mirrored the second mirroring carries %.3f %%, the third %.4f %%\n",
              100 * (mean[2] - mean[1]) / mean[3], 100 * (mean[3] - mean[2]) / mean[3]);
  EXPECT_GT(mean[2], mean[1]);
  EXPECT_LT(mean[3] - mean[2], 1e-4 * mean[3]);
}

}  // namespace
}  // namespace alabaster

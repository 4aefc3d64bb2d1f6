// Every kind of light on a large ball of high albedo, where diffusion is right, against the path tracer: what the
// renderer's samples, shadow maps and cut sky send is what the light is.
#include <cmath>
#include <cstdio>

#include "compare/compare.h"
#include "pipeline/render.h"
#include "reference/reference.h"
#include "scene/demo_scenes.h"
#include "support/device.h"

namespace alabaster {
namespace {

class LightsAgainstReference : public GpuTest {
 protected:
  static Scene unlit() {
    Scene scene = demo_scene("sphere-200mfp-0.99-1.3", "none");
    while (scene.objects.size() > 1) scene.objects.pop_back();  // the lamps
    return scene;
  }

  void expect_equal(const Scene& scene) {
    Request request;
    request.size = {80, 60};
    request.grid = 48;
    const Picture test =
        render_scene(context, scene, make_plan(scene, request, context.info().heap_bytes)).shaded.picture;
    ReferenceOptions options;
    options.width = 80;
    options.height = 60;
    options.samples = 96;
    CompareOptions layer;
    layer.layer = "subsurface";
    const Comparison c = compare(test, render_reference(scene, options), layer);
    ASSERT_TRUE(c.z);
    std::printf("mean %.5f, reference %.5f, bias %+.2f %% (%.1f standard errors), RMSE without noise %.2f %%\n",
                c.all.mean_test, c.all.mean_reference, 100 * c.all.bias, c.z->bias_z, 100 * c.z->corrected_rmse);
    EXPECT_LT(std::abs(c.all.bias), 0.02);
    EXPECT_LT(c.z->corrected_rmse, 0.04);
  }
};

TEST_F(LightsAgainstReference, SkyWithASun) {
  Scene scene = unlit();
  const glm::ivec2 size(64, 32);
  std::vector<glm::vec3> texels;
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) {
      const bool sun = y > 8 && y < 12 && x > 40 && x < 44;
      const float sky = y < size.y / 2 ? 1 - 0.04f * static_cast<float>(y) : 0.2f;
      texels.push_back(sun ? glm::vec3(90, 80, 60) : glm::vec3(0.6f, 0.8f, 1) * sky);
    }
  scene.environment.picture = std::make_shared<const EnvironmentPicture>(size, texels);
  expect_equal(scene);
}

TEST_F(LightsAgainstReference, Punctual) {
  using Kind = PunctualLight::Kind;
  const glm::vec3 eye(-0.2f, 0.25f, 0.3f), middle(0, 0.05f, 0);
  for (const auto& [kind, intensity, extent] :
       {std::tuple(Kind::point, 0.3f, 0.01), {Kind::spot, 0.3f, 0.01}, {Kind::directional, 2.f, 0.02}}) {
    Scene scene = unlit();
    scene.lights = {{"light", kind, glm::vec3(intensity), eye, glm::normalize(middle - eye), 0.1, 0.25, extent}};
    expect_equal(scene);
  }
}

}  // namespace
}  // namespace alabaster

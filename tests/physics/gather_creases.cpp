// Light in creases, by transport gather: the scanned dragon, lit from behind, many mean free paths thick and folded
// finer than the cells, shows no specks, neither dark ones nor the lamp behind it.
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "pipeline/render.h"
#include "scene/demo_scenes.h"
#include "support/device.h"

namespace alabaster {
namespace {

class GatherCreases : public GpuTest {};

TEST_F(GatherCreases, ShowNoSpecks) {
  if (!std::filesystem::exists(std::string(ALABASTER_MESHES) + "/ChineseDragon-10kv.off"))
    GTEST_SKIP() << "no dragon; third_party/fetch-meshes brings it";
  const Scene scene = demo_scene("dragon-homogeneous-50mfp-1.3", ALABASTER_MESHES);
  const int width = 160, height = 120;
  Request request;
  request.size = {width, height};
  request.grid = 64;
  request.transport = Transport::gather;
  request.light_samples = 8;
  request.interreflections = 0;
  request.components = {{Component::multiple}};  // all from inside, what is seen straight through, too
  const RenderResult r = render_scene(context, scene, make_plan(scene, request, context.info().heap_bytes));
  const std::vector<float>&light = r.shaded.picture.channels.at("multiple.G"),
        &cover = r.shaded.picture.channels.at("object.Y");
  int pixels = 0, dark = 0, bright = 0;
  for (int y = 2; y < height - 2; ++y)
    for (int x = 2; x < width - 2; ++x) {
      std::vector<float> around;
      for (int k = 0; k < 25; ++k) {
        const int i = x + k % 5 - 2 + width * (y + k / 5 - 2);
        if (cover[i] > 0.999f) around.push_back(light[i]);
      }
      if (around.size() < 25) continue;
      std::sort(around.begin(), around.end());
      ++pixels;
      dark += light[x + width * y] < 0.6f * around[4];
      bright += light[x + width * y] > 1.6f * around[20];
    }
  std::printf("%d pixels, %d dark, %d bright\n", pixels, dark, bright);
  EXPECT_GT(pixels, 2000);
  EXPECT_EQ(dark, 0);
  EXPECT_EQ(bright, 0);
}

}  // namespace
}  // namespace alabaster

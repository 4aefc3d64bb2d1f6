// What --components leaves out is out of the picture, and what it leaves adds up.
#include "support/device.h"
#include "support/furnace.h"

namespace alabaster {
namespace {

class Components : public GpuTest {
 protected:
  Picture render(std::optional<std::set<Component>> components) {
    const Scene scene = test::furnace_scene(icosphere(3), 1.5);
    Request request;
    request.grid = 16;
    request.size = {48, 36};
    request.components = std::move(components);
    return render_scene(context, scene, make_plan(scene, request, context.info().heap_bytes)).shaded.picture;
  }
};

TEST_F(Components, ChosenOnesAddUpToThePicture) {
  const Picture all = render({{Component::multiple, Component::surface}}), inner = render({{Component::multiple}}),
                mirrored = render({{Component::surface}});
  double inner_sum = 0, mirrored_sum = 0;
  for (std::size_t i = 0; i < all.channels.at("G").size(); ++i) {
    EXPECT_NEAR(inner.channels.at("G")[i] + mirrored.channels.at("G")[i], all.channels.at("G")[i], 1e-5);
    EXPECT_EQ(inner.channels.at("surface.G")[i], 0);
    EXPECT_EQ(mirrored.channels.at("multiple.G")[i], 0);
    inner_sum += inner.channels.at("G")[i];
    mirrored_sum += mirrored.channels.at("G")[i];
  }
  EXPECT_GT(inner_sum, 1);
  EXPECT_GT(mirrored_sum, 1);
}

}  // namespace
}  // namespace alabaster

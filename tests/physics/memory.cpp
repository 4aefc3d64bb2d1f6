// What the planner says of memory is what a render takes, and what does not fit is refused before it starts.
#include "scene/error.h"
#include "support/device.h"
#include "support/furnace.h"

namespace alabaster {
namespace {

class Memory : public GpuTest {
 protected:
  Scene scene = test::furnace_scene(torus(0.35f, 0.15f, 48, 24), 1.3);
  Request request;
};

TEST_F(Memory, RenderTakesWhatThePlannerSays) {
  request.size = {32, 24};
  request.transport = Transport::gather;
  request.grid = 64;
  request.interreflections = 1;
  const Plan plan = make_plan(scene, request, context.info().heap_bytes);
  render_scene(context, scene, plan);
  const double said = double(bytes_needed(scene, plan, plan.grid)), taken = double(context.peak_bytes());
  EXPECT_LT(taken, said);
  EXPECT_GT(taken, 0.5 * said);
}

TEST_F(Memory, LargestGridThatFitsIsNamedAndFits) {
  request.grid = 400;
  std::string said;
  try {
    make_plan(scene, request, std::uint64_t(1) << 30);
  } catch (const UserError& error) {
    said = error.what();
  }
  const std::size_t at = said.find("4 to ");
  ASSERT_NE(at, std::string::npos) << said;
  const int most = std::stoi(said.substr(at + 5));
  EXPECT_GT(most, 100);
  EXPECT_LT(most, 400);
  request.grid = most;
  EXPECT_EQ(make_plan(scene, request, std::uint64_t(1) << 30).grid, most);
  request.grid.reset();
  request.quality = Quality::accurate;
  EXPECT_LT(make_plan(scene, request, std::uint64_t(1) << 28).grid, 128);  // by itself it takes what fits
}

}  // namespace
}  // namespace alabaster

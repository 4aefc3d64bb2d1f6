// gpu/: passes by reflection, constants, copies, timers, and what it says when a caller is wrong.
#include <chrono>

#include "support/device.h"

namespace alabaster {
namespace {

struct Axpy {
  float a;
  std::uint32_t count;
};

class GpuPass : public GpuTest {
 protected:
  static constexpr std::uint32_t n = 1000;
  std::vector<float> x = std::vector<float>(n, 2.f), y = std::vector<float>(n, 1.f);
  gpu::Buffer bx = gpu::make_buffer(context, x, "x"), by = gpu::make_buffer(context, y, "y");
  gpu::Image image = gpu::image3d(context, {n, 1, 1}, VK_FORMAT_R32_SFLOAT, "copy");
};

TEST_F(GpuPass, RunsWithConstantsPushAndTimers) {
  const gpu::Pass axpy(context, "test/axpy.comp", {0.5f});
  EXPECT_EQ(axpy.layout().reflection.push_bytes, sizeof(Axpy));
  gpu::Commands commands(context);
  {
    auto timer = commands.time("axpy");
    commands.dispatch(axpy, {n, 1, 1}, {{"x", bx}, {"y", by}, {"copy", image}}, Axpy{3.f, n});
    commands.dispatch(axpy, {n, 1, 1}, {{"x", bx}, {"y", by}, {"copy", image}}, Axpy{3.f, n});
  }
  commands.submit();
  EXPECT_EQ(gpu::download<float>(context, by), std::vector<float>(n, 14.f));
  EXPECT_EQ(gpu::download<float>(context, image), std::vector<float>(n, 14.f));
  EXPECT_GT(context.timings().at("axpy"), 0);
  commands.submit();  // recorded once, run twice
  EXPECT_EQ(gpu::download<float>(context, by), std::vector<float>(n, 27.f));
}

// Once it has drawn anything, lavapipe takes a timestamp when it next flushes: a pass by itself came out at nothing.
TEST_F(GpuPass, TimesAPassByItself) {
  constexpr std::uint32_t many = 65535 * 64;
  const std::vector<float> ones(many, 1.f);
  const gpu::Buffer big_x = gpu::make_buffer(context, ones, "big x"), big_y = gpu::make_buffer(context, ones, "big y");
  const gpu::Pass axpy(context, "test/axpy.comp");
  (void)axpy.pipeline();
  gpu::ImageSpec spec;
  spec.size = {64, 64, 1};
  spec.format = VK_FORMAT_D32_SFLOAT;
  spec.type = VK_IMAGE_TYPE_2D;
  spec.usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
  const gpu::Image depth(context, spec, "depth");
  gpu::Commands commands(context);
  gpu::Targets targets;
  targets.size = {64, 64};
  targets.depth = &depth;
  commands.begin_rendering(targets);
  commands.end_rendering();
  {
    const auto timer = commands.time("by itself");
    commands.dispatch(axpy, {many, 1, 1}, {{"x", big_x}, {"y", big_y}, {"copy", image}}, Axpy{3.f, many});
  }
  const auto start = std::chrono::steady_clock::now();
  commands.submit();
  const double host = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  EXPECT_GT(context.timings().at("by itself"), 0.3 * host);
}

TEST_F(GpuPass, RefusesWrongBindings) {
  const gpu::Pass axpy(context, "test/axpy.comp");
  gpu::Commands commands(context);
  EXPECT_THROW(commands.dispatch(axpy, {n, 1, 1}, {{"x", bx}, {"y", by}}, Axpy{1, n}), std::logic_error);
  EXPECT_THROW(commands.dispatch(axpy, {n, 1, 1}, {{"x", bx}, {"y", image}, {"copy", image}}, Axpy{1, n}),
               std::logic_error);
  EXPECT_THROW(commands.dispatch(axpy, {n, 1, 1}, {{"x", bx}, {"y", by}, {"copy", image}, {"z", by}}, Axpy{1, n}),
               std::logic_error);
  EXPECT_THROW(commands.dispatch(axpy, {n, 1, 1}, {{"x", bx}, {"y", by}, {"copy", image}}, 1.0f), std::logic_error);
  EXPECT_THROW(gpu::Pass(context, "test/nothing.comp"), std::logic_error);
}

TEST_F(GpuPass, CountsMemoryAndRefusesTooMuch) {
  const std::uint64_t before = context.allocated_bytes();
  {
    const gpu::Buffer buffer(context, 1 << 20, "a MiB");
    EXPECT_GE(context.allocated_bytes(), before + (1 << 20));
  }
  EXPECT_EQ(context.allocated_bytes(), before);
  EXPECT_THROW(gpu::image3d(context, {1 << 20, 1, 1}, VK_FORMAT_R32_SFLOAT, "too wide"), gpu::DeviceError);
}

TEST(GpuContext, NamesTheDevicesThereAre) {
  EXPECT_FALSE(gpu::list_devices().empty());
  try {
    gpu::ContextOptions options;
    options.device = "no such device";
    gpu::Context context(options);
    FAIL();
  } catch (const gpu::DeviceError& e) {
    EXPECT_NE(std::string(e.what()).find("there are: "), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace alabaster

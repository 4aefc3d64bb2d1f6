// The light in a lamp's half shadow against the number of light samples: with shadow maps, and with exact visibility.
#include "scene/shapes.h"
#include "support/lighting_twin.h"
#include "support/lit_scene.h"

namespace alabaster {
namespace {

class SoftShadow : public GpuTest {
 protected:
  /// A plate of stone under a square lamp, an opaque blade half-way up, and receivers across the half shadow.
  SoftShadow() {
    Object plate = make_object(Role::translucent, transformed(box({0.2f, 0.02f, 0.2f}), translation({0, -0.01, 0})));
    plate.eta = 1.3;
    Object blade = make_object(Role::opaque, transformed(box({0.1f, 0.002f, 0.2f}), translation({-0.05, 0.06, 0})));
    const glm::dmat4 down = translation({0, 0.2, 0}) * rotation({1, 0, 0}, 180);
    scene.objects = {plate, blade, make_light(transformed(quad(0.1f, 0.1f), down), {10, 10, 10})};
    for (int i = 0; i < 16; ++i)
      for (int k = 0; k < 40; ++k)
        receivers.push_back({{-0.05f + 0.1f * (static_cast<float>(k) + 0.5f) / 40, 0,
                              -0.05f + 0.1f * (static_cast<float>(i) + 0.5f) / 16},
                             {0, 1, 0},
                             0});
    const LightSamples many = sample_lights(scene, 1024);
    for (const Receiver& r : receivers) truth.push_back(exact_flux(scene, many, r, 1.3).g);
  }

  template <class Value>
  double error(Value value) const {
    double square = 0, norm = 0;
    for (std::size_t i = 0; i < truth.size(); ++i)
      square += (value(i) - truth[i]) * (value(i) - truth[i]), norm += truth[i] * truth[i];
    return std::sqrt(square / norm);
  }

  Scene scene;
  std::vector<Receiver> receivers;
  std::vector<double> truth;
};

TEST_F(SoftShadow, ConvergesWithTheNumberOfLightSamples) {
  std::printf("| light samples | with shadow maps of 512 | with exact visibility |\n| --- | --- | --- |\n");
  double first = 0, last = 0;
  for (int samples : {4, 8, 16, 32, 64, 128, 256}) {
    const LitScene lit(context, scene, {samples, 0, 512});
    const std::vector<glm::vec3> flux = lit.gather(receivers, 1.3);
    const double mapped = error([&](std::size_t i) { return static_cast<double>(flux[i].g); });
    const double exact =
        error([&](std::size_t i) { return exact_flux(scene, lit.lighting.samples(), receivers[i], 1.3).g; });
    std::printf("| %d | %.2f %% | %.2f %% |\n", samples, 100 * mapped, 100 * exact);
    if (samples == 4) first = mapped;
    if (samples == 64) last = mapped;
    EXPECT_LT(std::abs(mapped - exact), 0.1 * exact + 0.002) << samples;  // the maps add next to nothing
  }
  EXPECT_LT(last, first / 4);  // order 1/2 or better
}

}  // namespace
}  // namespace alabaster

// The light of a lamp whose texture is half dark, on the ground below it: the closed form of the bright half, by the
// renderer's light samples and by the path tracer.
#include "reference/world.h"
#include "reference_scenes.h"
#include "scene/emission.h"
#include "support/lighting_twin.h"
#include "support/lit_scene.h"

namespace alabaster {
namespace {

using testing_scenes::Estimate;
using testing_scenes::Ray;

constexpr double half_x = 0.4, half_z = 0.25, height = 1;
constexpr float radiance = 3, grey = 0.6f;

/// Irradiance at the foot of a level rectangle's corner, over its radiance (a and b its sides, 1 above).
double corner(double a, double b) {
  const double p = std::sqrt(1 + a * a), q = std::sqrt(1 + b * b);
  return 0.5 * (a / p * std::atan(b / p) + b / q * std::atan(a / q));
}

/// By the bright half, x from 0 to half_x, at (x, z) on the ground.
double exact(double x, double z) {
  const auto up_to = [&](double a, double b) {
    return (a < 0 ? -1 : 1) * (b < 0 ? -1 : 1) * corner(std::abs(a), std::abs(b));
  };
  const double left = -x, right = half_x - x, near = -half_z - z, far = half_z - z;
  return radiance * (up_to(right, far) - up_to(left, far) - up_to(right, near) + up_to(left, near));
}

Scene half_dark() {
  Object lamp;
  lamp.name = "lamp";
  lamp.role = Role::emissive;
  lamp.radiance = glm::vec3(radiance);
  lamp.mesh = flipped(transformed(quad(2 * float(half_x), 2 * float(half_z)), translation({0, height, 0})));
  std::vector<glm::vec2> texcoords;
  for (glm::vec3 p : lamp.mesh.positions)
    texcoords.emplace_back(p.x / (2 * float(half_x)) + 0.5f, p.z / (2 * float(half_z)) + 0.5f);
  EmissionTexture texture;
  texture.size = {2, 1};
  texture.texels = {glm::vec3(0), glm::vec3(1)};
  Scene scene;
  Object ground = make_object(Role::opaque, quad(4, 4));
  ground.albedo = glm::vec3(grey);
  scene.objects = {ground};
  for (Object& part : cut_by_texels(lamp, texcoords, texture, "lamp")) scene.objects.push_back(std::move(part));
  return scene;
}

const glm::vec3 places[] = {{0, 0, 0}, {0.3f, 0, 0.1f}, {-0.5f, 0, 0.2f}};

class TexturedLamp : public GpuTest {};

// As near as the samples of a lamp of one colour come (LightingGather.AreaLightConvergesToQuadrature).
TEST_F(TexturedLamp, SamplesSendTheClosedForm) {
  for (const auto& [samples, within] : {std::pair{32, 0.01}, {128, 0.003}}) {
    const LitScene lit(context, half_dark(), {samples, 0, 64});
    std::vector<Receiver> receivers;
    for (const glm::vec3& p : places) receivers.push_back({p, {0, 1, 0}, 0});
    const std::vector<glm::vec3> flux = lit.gather(receivers, 1);
    for (std::size_t i = 0; i < receivers.size(); ++i)
      EXPECT_NEAR(flux[i].r / exact(places[i].x, places[i].z), 1, within) << samples << " " << i;
  }
}

TEST(TexturedLampReference, PathsSendTheClosedForm) {
  const World world(half_dark());
  for (const glm::vec3& p : places) {
    const Estimate e = testing_scenes::radiance(world, 200000, 3, [&](Random&) {
      return Ray{p + glm::vec3(0, 0.5f, 0), {0, -1, 0}};
    });
    const double expected = grey / M_PI * exact(p.x, p.z);
    EXPECT_NEAR(e.mean.r, expected, 4 * e.error.r + 1e-4 * expected);
    EXPECT_LT(e.error.r, 0.01 * expected);
  }
}

}  // namespace
}  // namespace alabaster

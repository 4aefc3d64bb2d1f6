// Point, spot and directional lights on the device: closed forms of their irradiance and of their shadows.
#include "scene/shapes.h"
#include "support/lighting_twin.h"
#include "support/lit_scene.h"

namespace alabaster {
namespace {

using Kind = PunctualLight::Kind;

class LightingPunctual : public GpuTest {};

/// Receivers that look up on a square around the origin.
std::vector<Receiver> floor_receivers(float half, int edge) {
  std::vector<Receiver> receivers;
  for (int j = 0; j < edge; ++j)
    for (int i = 0; i < edge; ++i)
      receivers.push_back(
          {{half * (2 * (float(i) + 0.5f) / float(edge) - 1), 0, half * (2 * (float(j) + 0.5f) / float(edge) - 1)},
           {0, 1, 0},
           0});
  return receivers;
}

Scene under(const PunctualLight& light) {
  Scene scene;
  scene.objects = {make_object(Role::translucent, transformed(box({0.2f, 0.02f, 0.2f}), translation({0, 0.5, 0}))),
                   make_object(Role::opaque, quad(4, 4))};
  scene.lights = {light};
  return scene;
}

/// KHR_lights_punctual's fall of a spot.
double fall(const PunctualLight& light, double cosine) {
  const double t = (cosine - std::cos(light.outer_cone)) / (std::cos(light.inner_cone) - std::cos(light.outer_cone));
  return std::pow(std::clamp(t, 0.0, 1.0), 2);
}

/// Largest difference from the closed form, over the intensity, at places more than `edge` (m) from the shadow's edge.
double worst(gpu::Context& context, const PunctualLight& light, double edge, int* in_shadow = nullptr) {
  const LitScene lit(context, under(light), {8, 0, 256});
  const std::vector<Receiver> receivers = floor_receivers(0.6f, 40);
  double worst = 0;
  const double eta = 1.3;
  const std::vector<glm::vec3> flux = lit.gather(receivers, eta);
  for (std::size_t i = 0; i < receivers.size(); ++i) {
    const glm::dvec3 x = receivers[i].position;
    const bool far = light.kind == Kind::directional;
    const glm::dvec3 way = far ? -glm::dvec3(light.direction) : glm::dvec3(light.position) - x;
    const glm::dvec3 w = glm::normalize(way);
    // Where the way crosses the box's height: under its bottom or its top.
    double off = INFINITY;
    bool inside = false;
    for (double y : {0.49, 0.51}) {
      const glm::dvec3 at = x + w * (y / w.y);
      const double outside = std::max(std::abs(at.x), std::abs(at.z)) - 0.1;
      off = std::min(off, std::abs(outside));
      inside = inside || outside < 0;
    }
    if (off < edge) continue;
    double expected = w.y * fresnel_transmittance(w.y, eta) / (far ? 1 : glm::dot(way, way));
    if (light.kind == Kind::spot) expected *= fall(light, -glm::dot(w, glm::dvec3(light.direction)));
    if (inside) expected = 0;
    if (in_shadow) *in_shadow += inside;
    worst = std::max(worst, std::abs(flux[i].g / light.intensity.g - expected));
  }
  return worst;
}

TEST_F(LightingPunctual, IdealLightsAreTheirClosedForms) {
  const PunctualLight point{"", Kind::point, {3, 2, 1}, {0.1f, 1.0f, 0.2f}, {0, 0, -1}, 0, 0.7, 0};
  const PunctualLight spot{"", Kind::spot, {3, 2, 1}, {0.1f, 1.0f, 0.2f}, {0, -1, 0}, 0.2, 0.5, 0};
  const PunctualLight sun{"", Kind::directional, {3, 2, 1}, {0, 0, 0}, {0.28f, -0.96f, 0}, 0, 0.7, 0};
  for (const PunctualLight& light : {point, spot, sun}) {
    int in_shadow = 0;
    EXPECT_LT(worst(context, light, 0.01, &in_shadow), 1e-5);
    EXPECT_GT(in_shadow, 20);
  }
}

TEST_F(LightingPunctual, ANearPointIsShadowedAllAround) {  // its maps are the faces of a cube
  Scene scene;
  scene.objects = {make_object(Role::translucent, transformed(torus(1, 0.2f, 48, 24), rotation({1, 0, 0}, 20)))};
  scene.lights = {{"", Kind::point, {1, 1, 1}, {0.05f, 0.1f, 0}, {0, 0, -1}, 0, 0.7, 0}};
  const LitScene lit(context, scene, {8, 0, 256});
  EXPECT_EQ(lit.lighting.maps(), 6u);
  const std::vector<Receiver> receivers = face_receivers(scene.objects[0].mesh);
  const std::vector<glm::vec3> flux = lit.gather(receivers, 1);
  double wrong = 0, sum = 0;
  for (std::size_t i = 0; i < receivers.size(); ++i) {
    const double twin = exact_flux(scene, lit.lighting.samples(), receivers[i], 1).r;
    sum += twin;
    wrong += std::abs(twin - flux[i].r);
  }
  EXPECT_LT(wrong, 0.01 * sum);
}

TEST_F(LightingPunctual, ALittleExtentSendsTheSame) {
  const PunctualLight point{"", Kind::point, {3, 2, 1}, {0.1f, 1.0f, 0.2f}, {0, 0, -1}, 0, 0.7, 0.02};
  const PunctualLight spot{"", Kind::spot, {3, 2, 1}, {0.1f, 1.0f, 0.2f}, {0, -1, 0}, 0.2, 0.5, 0.02};
  const PunctualLight sun{"", Kind::directional, {3, 2, 1}, {0, 0, 0}, {0.28f, -0.96f, 0}, 0, 0.7, 0.02};
  EXPECT_LT(worst(context, point, 0.03), 0.002);
  EXPECT_LT(worst(context, sun, 0.03), 0.002);
  EXPECT_LT(worst(context, spot, 0.03), 0.02);  // its fall bends within the sphere's 0.04 radians
  // Between lit and dark there is an edge now.
  const LitScene lit(context, under(point), {8, 0, 512});
  EXPECT_EQ(lit.lighting.samples().area.size(), 8u);
}

}  // namespace
}  // namespace alabaster

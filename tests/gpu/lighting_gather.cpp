// lighting/gather.comp and the shadow maps against the double-precision twin with exact visibility.
#include <random>

#include "scene/error.h"
#include "scene/shapes.h"
#include "support/lighting_twin.h"
#include "support/lit_scene.h"

namespace alabaster {
namespace {

constexpr double pi = 3.14159265358979323846;

/// The light quad of `size` at `at`, turned so that its front looks towards the origin.
Mesh light_quad(float size, glm::dvec3 at) {
  return transformed(quad(size, size), glm::dmat4(look_at(at, {0, 0, 0}, {0.1, 1, 0.2})) * rotation({1, 0, 0}, -90));
}

double worst_difference(const std::vector<glm::vec3>& a, const std::vector<glm::dvec3>& b, double scale) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(a[i][c] - b[i][c]) / scale);
  return worst;
}

class LightingGather : public GpuTest {};

TEST_F(LightingGather, EqualsItsTwinWithoutShadows) {
  Scene scene;
  scene.objects = {make_object(Role::translucent, icosphere(1, 0.01f)),
                   make_light(light_quad(0.7f, {1, 2, 0.5}), {3, 2, 1}),
                   make_light(light_quad(0.2f, {-2, 0.3, 0.5}), {9, 5, 1}, true)};
  const LitScene lit(context, scene, {40, 0, 64});
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<Receiver> receivers;
  for (int i = 0; i < 500; ++i)  // away from the little sphere that the maps are fitted to
    receivers.push_back({glm::vec3(0.3f, 1, 0.2f) + 0.3f * glm::vec3(uniform(random), uniform(random), uniform(random)),
                         glm::normalize(glm::vec3(uniform(random), uniform(random), uniform(random))), 0});
  for (double eta : {0.8, 1.0, 1.3, 1.5}) {
    std::vector<glm::dvec3> twin;
    double scale = 0;
    for (const Receiver& r : receivers) {
      twin.push_back(exact_flux(scene, lit.lighting.samples(), r, eta, false));
      scale = std::max(scale, glm::length(twin.back()));
    }
    EXPECT_LT(worst_difference(lit.gather(receivers, eta), twin, scale), 1e-5) << "eta " << eta;
  }
}

// Shares of the light points: each part of the receivers against the twin with the points of its share alone, n-fold.
// The lights are an area light, whose points follow each other's maps, and a point light, which has six.
TEST_F(LightingGather, SharedGatherEqualsTwin) {
  Scene scene;
  scene.objects = {make_object(Role::translucent, icosphere(1, 0.01f)),
                   make_light(light_quad(0.7f, {1, 2, 0.5}), {300, 200, 100})};
  scene.lights.push_back({});
  scene.lights.back().intensity = {5, 4, 3};
  scene.lights.back().position = {-1, 2, 0.3f};
  const LitScene lit(context, scene, {21, 0, 64});
  const std::size_t points = lit.lighting.samples().area.size();
  EXPECT_GT(points, 12u);
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<Receiver> receivers;
  for (int i = 0; i < 90; ++i)
    receivers.push_back({glm::vec3(0.3f, 1, 0.2f) + 0.3f * glm::vec3(uniform(random), uniform(random), uniform(random)),
                         glm::normalize(glm::vec3(uniform(random), uniform(random), uniform(random))), 0});
  const std::vector<std::uint32_t> shares = {50, 0, 40};
  const gpu::Buffer in = gpu::make_buffer(context, receivers, "receivers");
  const gpu::Buffer out(context, receivers.size() * sizeof(glm::vec3), "irradiance");
  gpu::Commands commands(context);
  lit.lighting.record_shared_gather(commands, in, shares, out);
  commands.submit();
  const std::vector<glm::vec3> flux = gpu::download<glm::vec3>(context, out);
  std::vector<glm::dvec3> twin;
  double scale = 0;
  for (std::size_t i = 0; i < receivers.size(); ++i) {
    LightSamples share;
    for (std::size_t k = i < 50 ? 0 : 2; k < points; k += 3) share.area.push_back(lit.lighting.samples().area[k]);
    twin.push_back(3.0 * exact_flux(scene, share, receivers[i], 1, false));
    scale = std::max(scale, glm::length(twin.back()));
  }
  EXPECT_LT(worst_difference(std::vector<glm::vec3>(flux.begin(), flux.begin() + 90), twin, scale), 1e-5);
}

TEST_F(LightingGather, UnblockedEnvironmentIsExact) {
  Scene scene;
  scene.objects = {make_object(Role::translucent, ellipsoid(4, {1, 0.6f, 0.3f}))};
  scene.environment.radiance = {1, 2, 4};
  const LitScene lit(context, scene, {1, 100, 256});
  const std::vector<Receiver> receivers = face_receivers(scene.objects[0].mesh);
  for (double eta : {0.8, 1.0, 1.3, 1.5})
    for (const glm::vec3& flux : lit.gather(receivers, eta))
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(flux[c] / (scene.environment.radiance[c] * pi * (1 - diffuse_reflectance(eta))), 1, 1e-5);
}

/// Flux through a level receiver from a level rectangle above it, by brute quadrature.
double rectangle_flux(glm::dvec3 x, glm::dvec2 half, double height, double eta) {
  const int n = 400;
  double sum = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const glm::dvec3 y = {half.x * (2 * (i + 0.5) / n - 1), height, half.y * (2 * (j + 0.5) / n - 1)};
      const glm::dvec3 way = y - x;
      const double d2 = glm::dot(way, way), cosine = way.y / std::sqrt(d2);
      sum += point_transfer(cosine, cosine, d2, eta);
    }
  return sum * 4 * half.x * half.y / n / n;
}

TEST_F(LightingGather, AreaLightConvergesToQuadrature) {
  const std::vector<glm::vec3> places = {{0, 0, 0}, {0.3f, 0, 0.1f}, {-0.5f, 0, 0.6f}, {1.5f, 0, 0}};
  for (double eta : {1.0, 1.4}) {
    std::vector<double> errors;
    for (int samples : {8, 32, 128}) {
      Scene scene;
      scene.objects = {make_object(Role::opaque, transformed(icosphere(1, 0.01f), translation({0, -1, 0}))),
                       make_light(flipped(transformed(quad(0.8f, 0.5f), translation({0, 1, 0}))), {1, 2, 3})};
      const LitScene lit(context, scene, {samples, 0, 64});
      std::vector<Receiver> receivers;
      for (const glm::vec3& p : places) receivers.push_back({p, {0, 1, 0}, 0});
      const std::vector<glm::vec3> flux = lit.gather(receivers, eta);
      double error = 0;
      for (std::size_t i = 0; i < places.size(); ++i) {
        const double exact = rectangle_flux(places[i], {0.4, 0.25}, 1, eta);
        for (int c = 0; c < 3; ++c) error = std::max(error, std::abs(flux[i][c] / ((c + 1) * exact) - 1));
      }
      errors.push_back(error);
    }
    RecordProperty("errors_eta_" + std::to_string(eta),
                   std::to_string(errors[0]) + " " + std::to_string(errors[1]) + " " + std::to_string(errors[2]));
    EXPECT_LT(errors[0], 0.008);
    EXPECT_LT(errors[1], 0.002);
    EXPECT_LT(errors[2], 0.002);
    EXPECT_LT(errors[2], errors[0] / 4);
  }
}

TEST_F(LightingGather, ConvexSurfacesDoNotShadowThemselves) {
  for (const Mesh& mesh : {icosphere(4, 0.05f), box({0.1f, 0.06f, 0.08f}, 8), ellipsoid(4, {0.05f, 0.01f, 0.03f})})
    for (const glm::dvec3& at : {glm::dvec3(0.5, 0.4, 0.1), glm::dvec3(0.07, 0, 0), glm::dvec3(-0.02, -5, 3)}) {
      Scene scene;  // lit from afar, and from so near that most of the lit side is at grazing angles
      scene.objects = {make_object(Role::translucent, mesh), make_light(light_quad(0.01f, at), {1, 1, 1})};
      const LitScene lit(context, scene, {4, 0, 256});
      const std::vector<Receiver> receivers = face_receivers(mesh);
      const std::vector<glm::vec3> flux = lit.gather(receivers, 1.3);
      double worst = 0, brightest = 0;
      for (std::size_t i = 0; i < receivers.size(); ++i) {
        const double open = exact_flux(scene, lit.lighting.samples(), receivers[i], 1.3, false).r;
        brightest = std::max(brightest, open);
        worst = std::max(worst, std::abs(flux[i].r - open));
      }
      EXPECT_GT(brightest, 0);
      EXPECT_LT(worst, 1e-4 * brightest) << at.x;
    }
}

TEST_F(LightingGather, NothingLeaksBehindAThinPlate) {
  Scene scene;  // a plate 1 m above the ground; the ground is wider, the light small and straight above
  const Mesh ground = transformed(quad(6, 6), translation({0, -1, 0}));
  scene.objects = {make_object(Role::translucent, box({1, 0.001f, 1})), make_object(Role::opaque, ground),
                   make_light(light_quad(1e-3f, {0, 3, 0}), {1e6, 1e6, 1e6})};
  const int map_size = 256;
  const LitScene lit(context, scene, {1, 0, map_size});

  // On the dark side of the plate itself nothing arrives, up to its very edges.
  std::vector<Receiver> under;
  for (float i = -20; i <= 20; ++i) under.push_back({{0.0249f * i, -0.0005f, 0.01f * i}, {0, -1, 0}, 0});
  // Close under it, looking up: all of the plate's shadow.
  for (float i = -20; i <= 20; ++i) under.push_back({{0.0235f * i, -0.002f, 0.01f * i}, {0, 1, 0}, 0});
  for (const glm::vec3& flux : lit.gather(under, 1)) EXPECT_EQ(flux.r, 0);

  // On the ground the shadow's edge is at 2/3 m (light at 3, plate at 0, ground at -1): within a texel, either side.
  const double texel = 4.0 * 2 * (0.5 / 3) * (1 + 8.0 / map_size) / map_size;
  const double edge = 0.5 * 4 / 3;
  std::vector<Receiver> across;
  for (int i = 0; i < 400; ++i) across.push_back({{0.4f + 0.001f * static_cast<float>(i), -1, 0.1f}, {0, 1, 0}, 0});
  const std::vector<glm::vec3> flux = lit.gather(across, 1);
  for (std::size_t i = 0; i < across.size(); ++i) {
    const double open = exact_flux(scene, lit.lighting.samples(), across[i], 1, false).r;
    const double past = across[i].position.x - edge;
    if (std::abs(past) > 1.5 * texel) {
      EXPECT_NEAR(flux[i].r / open, past > 0, past > 0 ? 1e-4 : 0) << past / texel << " texels past the edge";
    }
  }
}

TEST_F(LightingGather, LightAmidTheObjectsShinesAllAround) {
  Scene scene;  // a small two-sided light between four spheres on a ring, one of them in the shadow of a fifth
  Mesh ring;
  for (int i = 0; i < 4; ++i)
    ring = joined(ring, transformed(icosphere(2, 0.3f), rotation({0, 1, 0}, 90.0 * i + 20) * translation({1, 0, 0})));
  ring = joined(ring, transformed(icosphere(2, 0.1f), rotation({0, 1, 0}, 20) * translation({0.4, 0, 0})));
  scene.objects = {make_object(Role::translucent, ring), make_light(light_quad(0.02f, {0, 0.05, 0}), {5, 5, 5}, true)};
  const LitScene lit(context, scene, {3, 0, 512});
  EXPECT_EQ(lit.lighting.maps(), 3 * 6);
  const std::vector<Receiver> receivers = face_receivers(ring);
  const std::vector<glm::vec3> flux = lit.gather(receivers, 1);
  double difference = 0, total = 0, shadowed = 0;
  for (std::size_t i = 0; i < receivers.size(); ++i) {
    const double exact = exact_flux(scene, lit.lighting.samples(), receivers[i], 1).r;
    total += exact;
    difference += std::abs(flux[i].r - exact);
    shadowed += exact_flux(scene, lit.lighting.samples(), receivers[i], 1, false).r - exact;
  }
  EXPECT_GT(shadowed, 0.05 * total);  // there is something to get wrong
  EXPECT_LT(difference, 0.01 * total);
}

TEST_F(LightingGather, BlockedEnvironmentEqualsExactVisibility) {
  Scene scene;  // a torus blocks its own hole, and a ball stands near it
  scene.objects = {make_object(Role::translucent, torus(0.05f, 0.02f, 24, 12)),
                   make_object(Role::opaque, transformed(icosphere(2, 0.03f), translation({0.09, 0.02, 0})))};
  scene.environment.radiance = {1, 1, 1};
  const LitScene lit(context, scene, {1, 64, 512});
  const std::vector<Receiver> receivers = face_receivers(scene.objects[0].mesh);
  const std::vector<glm::vec3> flux = lit.gather(receivers, 1.3);
  double difference = 0, total = 0, blocked = 0;
  for (std::size_t i = 0; i < receivers.size(); ++i) {
    const double exact = exact_flux(scene, lit.lighting.samples(), receivers[i], 1.3, true, 1e-5).r;
    total += exact;
    difference += std::abs(flux[i].r - exact);
    blocked += pi * (1 - diffuse_reflectance(1.3)) - exact;
  }
  EXPECT_GT(blocked, 0.1 * total);
  EXPECT_LT(difference, 0.01 * total);
}

TEST_F(LightingGather, BadSettingsAreTheUsersToMend) {
  Scene scene;
  scene.objects = {make_object(Role::translucent, icosphere(1)), make_light(light_quad(1, {0, 3, 0}), {1, 1, 1})};
  scene.environment.radiance = {1, 1, 1};
  for (const LightSettings& bad :
       {LightSettings{0, 0, 64}, {-1, 0, 64}, {100000, 0, 64}, {1, -1, 64}, {1, 1, 1}, {1000, 1000, 64}})
    EXPECT_THROW(LitScene(context, scene, bad), UserError)
        << bad.samples << " " << bad.directions << " " << bad.map_size;
}

}  // namespace
}  // namespace alabaster

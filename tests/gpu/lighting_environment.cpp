// Light from a picture of the environment: what it sends into surfaces, and how it is seen.
#include "scene/shapes.h"
#include "shading/shading.h"
#include "support/lighting_twin.h"
#include "support/lit_scene.h"

namespace alabaster {
namespace {

constexpr double pi = 3.14159265358979323846;

std::shared_ptr<const EnvironmentPicture> spots() {
  std::vector<glm::vec3> texels(64 * 32, glm::vec3(0.2f, 0.3f, 0.4f));
  for (int i = 0; i < 4; ++i) {
    texels[static_cast<std::size_t>((8 + i % 2) * 64 + 20 + i / 2)] = {90, 60, 30};
    texels[static_cast<std::size_t>((14 + i % 2) * 64 + 50 + i / 2)] = {9, 60, 90};
  }
  return std::make_shared<EnvironmentPicture>(glm::ivec2(64, 32), texels, 0.15f);
}

class LightingEnvironment : public GpuTest {};

// Within what 64 parts can know of it; a uniform environment is in closed form.
TEST_F(LightingEnvironment, EvenPictureIsNearTheUniformEnvironment) {
  Scene scene;
  scene.objects = {make_object(Role::translucent, ellipsoid(3, {1, 0.6f, 0.3f}))};
  const glm::vec3 level{1, 2, 4};
  scene.environment.picture = std::make_shared<EnvironmentPicture>(glm::ivec2(8, 4), std::vector<glm::vec3>(32, level));
  const LitScene lit(context, scene, {1, 64, 256});
  const std::vector<Receiver> receivers = face_receivers(scene.objects[0].mesh);
  for (double eta : {1.0, 1.3, 1.5}) {
    double worst = 0, mean = 0;
    for (const glm::vec3& flux : lit.gather(receivers, eta))
      for (int c = 0; c < 3; ++c) {
        const double off = flux[c] / (level[c] * pi * (1 - diffuse_reflectance(eta))) - 1;
        worst = std::max(worst, std::abs(off));
        mean += off / static_cast<double>(3 * receivers.size());
      }
    std::printf("eta %.1f: mean %+.3f %%, worst %.3f %%\n", eta, 100 * mean, 100 * worst);
    EXPECT_LT(worst, 0.015);
    EXPECT_LT(std::abs(mean), 0.005);
  }
}

TEST_F(LightingEnvironment, GatherEqualsItsTwin) {
  Scene scene;
  scene.objects = {make_object(Role::translucent, torus(0.05f, 0.02f, 24, 12)),
                   make_object(Role::opaque, transformed(icosphere(2, 0.03f), translation({0.09, 0.02, 0})))};
  scene.environment.picture = spots();
  const LitScene lit(context, scene, {1, 64, 512});
  EXPECT_LE(lit.lighting.samples().area.size(), 64u);
  const std::vector<Receiver> receivers = face_receivers(scene.objects[0].mesh);
  for (double eta : {1.0, 1.3}) {
    const std::vector<glm::vec3> flux = lit.gather(receivers, eta);
    glm::dvec3 difference(0), total(0), blocked(0);
    for (std::size_t i = 0; i < receivers.size(); ++i) {
      const glm::dvec3 exact = exact_flux(scene, lit.lighting.samples(), receivers[i], eta, true, 1e-5);
      total += exact;
      difference += glm::abs(glm::dvec3(flux[i]) - exact);
      blocked += exact_flux(scene, lit.lighting.samples(), receivers[i], eta, false) - exact;
    }
    for (int c = 0; c < 3; ++c) {
      EXPECT_GT(blocked[c], 0.05 * total[c]);
      EXPECT_LT(difference[c], 0.015 * total[c]);
    }
  }
}

TEST_F(LightingEnvironment, IsSeenBehindAndMirrored) {
  Scene scene;
  Object ball = make_object(Role::translucent, icosphere(4));
  ball.eta = 1.5;
  scene.objects = {ball};
  scene.environment.picture = spots();
  const LitScene lit(context, scene, {1, 8, 64});
  Camera camera;
  camera.y_fov = 1.2f;
  camera.to_world = look_at({0.5, 1, 3}, {0, 0, 0});
  const gpu::Image dark = gpu::image3d(context, {4, 4, 4}, VK_FORMAT_R32G32B32A32_SFLOAT, "dark");
  gpu::upload(context, dark, std::vector<glm::vec4>(64, glm::vec4(0)));
  const glm::ivec2 size(80, 60);
  const Picture picture = Shading(context)
                              .shade({lit.scene,
                                      lit.meshes,
                                      lit.lighting,
                                      {{0, {&dark, &dark}, {&dark, &dark}, {{4, 4, 4}, 0.6f, {-1.2f, -1.2f, -1.2f}}}},
                                      camera,
                                      {size, 1}})
                              .picture;
  const double tangent = std::tan(0.5 * camera.y_fov);
  int mirrored = 0, background = 0, off = 0;
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) {
      const auto i = static_cast<std::size_t>(y * size.x + x);
      const glm::dvec2 screen =
          (2.0 * (glm::dvec2(x, y) + 0.5) / glm::dvec2(size) - 1.0) * glm::dvec2(tangent * size.x / size.y, -tangent);
      glm::dvec3 ray = glm::normalize(glm::dvec3(glm::dmat4(camera.to_world) * glm::dvec4(screen, -1, 0)));
      double share = 1;
      if (picture.channels.at("object.Y")[i] > 0) {
        const glm::dvec3 n(picture.channels.at("N.X")[i], picture.channels.at("N.Y")[i], picture.channels.at("N.Z")[i]);
        share = 1 - fresnel_transmittance(-glm::dot(n, ray), 1.5);
        ray = glm::reflect(ray, n);
        ++mirrored;
      } else {
        ++background;
      }
      const glm::dvec3 exact = share * glm::dvec3(scene.environment.picture->radiance(glm::vec3(ray)));
      const glm::dvec3 seen(picture.channels.at("surface.R")[i], picture.channels.at("surface.G")[i],
                            picture.channels.at("surface.B")[i]);
      off += glm::distance(seen, exact) > 1e-3 * glm::length(exact);  // by rounding at a texel's edge
    }
  EXPECT_GT(mirrored, 300);
  EXPECT_GT(background, 300);
  EXPECT_LE(off, 10);
}

}  // namespace
}  // namespace alabaster

// The picture's layers against rays traced and shaded one by one in double precision.
#include "scene/error.h"
#include "scene/shapes.h"
#include "shading/shading.h"
#include "shared/optics.h"
#include "support/lighting_twin.h"
#include "support/lit_scene.h"

namespace alabaster {
namespace {

constexpr double pi = 3.14159265358979323846;

glm::dvec3 rgb(const Picture& picture, const std::string& layer, std::size_t i) {
  return {picture.channels.at(layer + "R")[i], picture.channels.at(layer + "G")[i],
          picture.channels.at(layer + "B")[i]};
}

class ShadingPicture : public GpuTest {
 protected:
  ShadingPicture() {
    Object ball = make_object(Role::translucent, transformed(icosphere(2, 0.5f), translation({-0.3, 0.5, 0})));
    ball.eta = 1.3;
    Object ground = make_object(Role::opaque, quad(4, 4));
    ground.albedo = {0.8f, 0.5f, 0.2f};
    const glm::dmat4 at_left = translation({-1.2, 0.6, -0.5}) * rotation({1, 0, 0}, 90);
    const glm::dmat4 at_right = translation({1.2, 0.6, -0.5}) * rotation({1, 0, 0}, -90);  // seen from behind
    scene.objects = {ball, ground, make_light(transformed(quad(0.5f, 0.5f), at_left), {2, 3, 4}),
                     make_light(transformed(quad(0.5f, 0.5f), at_right), {5, 5, 5})};
    scene.environment.radiance = {0.1f, 0.2f, 0.4f};
    camera.to_world = look_at({0.4, 1.5, 3.5}, {0, 0.4, 0});
    frame = {{8, 8, 8}, 0.25f, {-1.3f, -0.5f, -1}};
    std::vector<glm::vec4> phi, gammas;
    for (int k = 0; k < 8; ++k)
      for (int j = 0; j < 8; ++j)
        for (int i = 0; i < 8; ++i) {
          const glm::vec3 p = frame.origin + frame.h * (glm::vec3(i, j, k) + 0.5f);
          phi.push_back(glm::vec4(phi_at(p), 0));
          gammas.push_back(glm::vec4(gamma_at(p), 0));
        }
    fluence = gpu::image3d(context, {8, 8, 8}, VK_FORMAT_R32G32B32A32_SFLOAT, "fluence");
    gamma_s = gpu::image3d(context, {8, 8, 8}, VK_FORMAT_R32G32B32A32_SFLOAT, "Gamma_s");
    gpu::upload(context, fluence, phi);
    gpu::upload(context, gamma_s, gammas);
  }

  /// Linear, so that trilinear sampling is exact; blue is small enough for negative brackets.
  static glm::vec3 phi_at(glm::vec3 p) { return {4 + p.x, 3 + p.y, 0.6f + 0.2f * p.z}; }
  static glm::vec3 gamma_at(glm::vec3 p) { return {0.5f - 0.2f * p.y, 0.4f, 0.3f + 0.3f * p.z}; }

  ShadedPicture shade(const LitScene& lit, glm::ivec2 size, int samples) {
    return Shading(context).shade({lit.scene,
                                   lit.meshes,
                                   lit.lighting,
                                   {{0, {&fluence, &fluence}, {&gamma_s, &gamma_s}, frame}},
                                   camera,
                                   {size, samples}});
  }

  struct Truth {
    glm::dvec3 multiple{0}, surface{0}, fluence{0}, gamma{0}, normal{0};
    double distance = 0, translucent = 0;
    bool negative = false;
  };

  glm::dvec3 bracket_at(glm::dvec3 x, double eta) const {
    const double f_dr = internal_diffuse_reflectance(eta), A = boundary_constant(f_dr);
    glm::dvec3 bracket;
    for (int c = 0; c < 3; ++c)
      bracket[c] = query_bracket(static_cast<double>(phi_at(glm::vec3(x))[c]),
                                 static_cast<double>(gamma_at(glm::vec3(x))[c]), A, 1 - f_dr);
    return bracket;
  }

  /// What a ray brings that a smooth surface has mirrored with `share`: followed through two mirrorings.
  void follow(const LightSamples& lights, glm::dvec3 from, glm::dvec3 ray, double share, Truth& t) const {
    for (int order = 0; order < 2; ++order) {
      const Seen seen = nearest_hit(scene, from, ray, -1, 1e-6);
      if (seen.object < 0) break;
      const Object& object = scene.objects[static_cast<std::size_t>(seen.object)];
      glm::dvec3 n = normal_of(object, seen);
      const bool front = glm::dot(n, ray) < 0;
      from += seen.distance * ray;
      if (object.role == Role::emissive) {
        if (front || object.two_sided) t.surface += share * glm::dvec3(object.radiance);
        return;
      }
      if (!front) n = -n;
      if (object.role == Role::opaque) {
        const Receiver here{glm::vec3(from), glm::vec3(n), 0};
        t.surface += share / pi * glm::dvec3(object.albedo) * exact_flux(scene, lights, here, 1);
        return;
      }
      const double f_t = fresnel_transmittance(-glm::dot(n, ray), object.eta);
      for (int c = 0; c < 3; ++c)
        t.multiple[c] += share * query_radiance(std::max(bracket_at(from, object.eta)[c], 0.0), f_t,
                                                1 / (object.eta * object.eta));
      share *= 1 - f_t;
      ray -= 2 * glm::dot(n, ray) * n;
    }
    t.surface += share * glm::dvec3(scene.environment.radiance);
  }

  static glm::dvec3 normal_of(const Object& object, const Seen& seen) {
    const auto corner = [&](int i) { return glm::dvec3(object.mesh.positions[seen.triangle[i]]); };
    return glm::normalize(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
  }

  /// What is seen through the point (x, y) of a picture of `size`, pixels from the top left.
  Truth trace(const LightSamples& lights, glm::ivec2 size, glm::dvec2 at) const {
    Truth t;
    const double tangent = std::tan(0.5 * camera.y_fov);
    const glm::dvec2 screen = (2.0 * at / glm::dvec2(size) - 1.0) * glm::dvec2(tangent * size.x / size.y, -tangent);
    const glm::dvec3 eye = camera.to_world[3];
    const glm::dvec3 ray = glm::normalize(glm::dvec3(glm::dmat4(camera.to_world) * glm::dvec4(screen, -1, 0)));
    const Seen seen = nearest_hit(scene, eye, ray);
    if (seen.object < 0) {
      t.surface = scene.environment.radiance;
      return t;
    }
    const Object& object = scene.objects[seen.object];
    glm::dvec3 n = normal_of(object, seen);
    const glm::dvec3 x = eye + seen.distance * ray;
    t.distance = seen.distance;
    const bool front = glm::dot(n, ray) < 0;
    if (!front) n = -n;
    t.normal = n;
    if (object.role == Role::emissive) {
      if (front || object.two_sided) t.surface = object.radiance;
      return t;
    }
    const Receiver here{glm::vec3(x), glm::vec3(n), 0};
    if (object.role == Role::opaque) {
      t.surface = glm::dvec3(object.albedo) / pi * exact_flux(scene, lights, here, 1);
      return t;
    }
    const double eta = object.eta, f_t = fresnel_transmittance(-glm::dot(n, ray), eta);
    t.translucent = 1;
    t.fluence = phi_at(glm::vec3(x));
    t.gamma = gamma_at(glm::vec3(x));
    for (int c = 0; c < 3; ++c) {
      const double bracket = bracket_at(x, eta)[c];
      t.negative = t.negative || bracket < 0;
      t.multiple[c] = query_radiance(std::max(bracket, 0.0), f_t, 1 / (eta * eta));
    }
    follow(lights, x, ray - 2 * glm::dot(n, ray) * n, 1 - f_t, t);
    return t;
  }

  void compare_with_rays(const LightSettings& settings) {
    const LitScene lit(context, scene, settings);
    const glm::ivec2 size = {80, 60};
    const ShadedPicture shaded = shade(lit, size, 1);
    const Picture& p = shaded.picture;
    const double pixels = size.x * size.y;
    double negative = 0, translucent = 0, plain = 0, edges = 0, off = 0;
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const std::size_t i = static_cast<std::size_t>(y * size.x + x);
        const Truth t = trace(lit.lighting.samples(), size, {x + 0.5, y + 0.5});
        negative += t.negative;
        translucent += t.translucent;
        plain += t.distance > 0 && t.translucent == 0;
        const glm::dvec3 normal = {p.channels.at("N.X")[i], p.channels.at("N.Y")[i], p.channels.at("N.Z")[i]};
        if (glm::distance(normal, t.normal) > 1e-4) {  // the raster's rounding at an edge of a triangle
          ++edges;
          continue;
        }
        ASSERT_EQ(p.channels.at("object.Y")[i], t.translucent);
        ASSERT_NEAR(p.channels.at("Z")[i], t.distance, 1e-4 * t.distance);
        ASSERT_LT(glm::distance(rgb(p, "fluence.", i), t.fluence), 1e-4 * 8);
        ASSERT_LT(glm::distance(rgb(p, "", i), rgb(p, "multiple.", i) + rgb(p, "surface.", i)), 1e-6);
        // All but the edges of shadows, which the maps place to a texel.
        off += glm::distance(rgb(p, "gamma_s.", i), t.gamma) > 0.005 * glm::length(t.gamma) ||
               glm::distance(rgb(p, "surface.", i), t.surface) > 0.005 * glm::length(t.surface) ||
               glm::distance(rgb(p, "multiple.", i), t.multiple) > 0.005 * glm::length(t.multiple);
      }
    EXPECT_GT(translucent, 0.05 * pixels);
    EXPECT_GT(plain, 0.05 * pixels);
    EXPECT_GT(pixels - plain - translucent, 0.05 * pixels);
    EXPECT_LE(edges, 5);
    EXPECT_LT(off, 0.03 * pixels);
    RecordProperty("pixels_off", static_cast<int>(off));
    EXPECT_GT(negative, 8);
    EXPECT_NEAR(static_cast<double>(shaded.negative_pixels), negative, 2);
    EXPECT_NEAR(shaded.negative_share, negative / translucent, 0.05);
  }

  Scene scene;
  Camera camera;
  GridFrame frame;
  gpu::Image fluence, gamma_s;
};

TEST_F(ShadingPicture, EqualsRaysShadedOneByOneUnderAreaLights) {
  scene.environment.radiance = {0, 0, 0};
  compare_with_rays({8, 0, 512});
}

// The lights go: they would block the environment on the ground where the maps, fitted to the ball, do not reach.
TEST_F(ShadingPicture, EqualsRaysShadedOneByOneInTheEnvironment) {
  scene.objects.resize(2);
  scene.environment.radiance = {1, 2, 4};
  compare_with_rays({1, 24, 512});
}

TEST_F(ShadingPicture, PixelsAreTheMeanOfTheirSamples) {
  const LitScene lit(context, scene, {2, 0, 512});
  const glm::ivec2 size = {64, 48};
  const Picture fine = shade(lit, 2 * size, 1).picture, coarse = shade(lit, size, 4).picture;
  for (const char* name : {"R", "G", "B", "multiple.G", "surface.B", "object.Y"}) {
    double worst = 0, mean = 0, level = 0;
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const auto at = [&](int dx, int dy) {
          return fine.channels.at(name)[static_cast<std::size_t>((2 * y + dy) * 2 * size.x + 2 * x + dx)];
        };
        const double four = 0.25 * (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1));
        const double one = coarse.channels.at(name)[static_cast<std::size_t>(y * size.x + x)];
        worst = std::max(worst, std::abs(four - one));
        mean += one - four;
        level += four;
      }
    // Samples of one triangle are shaded together at their mean place: only what bends inside a pixel differs.
    EXPECT_LT(std::abs(mean), 1e-3 * level) << name;
    EXPECT_LE(worst, std::string(name) == "object.Y" ? 0 : level) << name;
  }
}

TEST_F(ShadingPicture, ObjectsWithoutFluenceStayBlack) {
  const LitScene lit(context, scene, {2, 0, 64});
  const Picture black =
      Shading(context).shade({lit.scene, lit.meshes, lit.lighting, {}, camera, {{32, 24}, 4}}).picture;
  for (float v : black.channels.at("object.Y")) EXPECT_EQ(v, 0);
}

TEST_F(ShadingPicture, RefusesFramesWithoutSense) {
  const LitScene lit(context, scene, {1, 0, 64});
  EXPECT_THROW(shade(lit, {10, 10}, 3), UserError);
  EXPECT_THROW(shade(lit, {10, 10}, 0), UserError);
  EXPECT_THROW(shade(lit, {0, 10}, 4), UserError);
  EXPECT_ANY_THROW(shade(lit, {1000000, 10}, 4));
}

}  // namespace
}  // namespace alabaster

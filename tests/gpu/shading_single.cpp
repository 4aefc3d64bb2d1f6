// shading/single.comp, single_flux.comp and single_take.comp: against the closed form below a plane, and on a ball
// against the integral along each view ray in double precision.
#include "shading/shading.h"
#include "shading/single.h"
#include "support/diffusion_device.h"
#include "support/lighting_twin.h"
#include "support/lit_scene.h"

namespace alabaster {
namespace {

constexpr double lamp_distance = 1000, lamp_radiance = 1e6;

/// Parallel light of irradiance `lamp_radiance` (2 / lamp_distance)^2 along -towards.
Object far_lamp(glm::dvec3 towards) {
  const glm::dmat4 place(look_at(lamp_distance * towards, {0, 0, 0}, {1, 0, 0}));
  return make_light(transformed(quad(2, 2), place * rotation({1, 0, 0}, -90)), glm::vec3(lamp_radiance));
}

class ShadingSingle : public GpuTest {
 protected:
  static Scene lit_scene(const Mesh& mesh, const Medium& medium, double eta, glm::dvec3 towards) {
    Scene scene;
    Object object = make_object(Role::translucent, mesh);
    object.eta = eta;
    object.medium = medium;
    scene.objects = {object, far_lamp(towards)};
    return scene;
  }

  /// The picture with the layer `single`, one sample a pixel.
  ShadedPicture shade(const LitScene& lit, const Camera& camera, glm::ivec2 size, int cells, int channels) {
    const Object& object = lit.scene.objects[0];
    Body body(context, object.mesh, cells, field_of(object.medium), channels, object.eta);
    body.solve(glm::vec3(0.25f));
    SingleScattering single(context, body.domain(), body.diffusion(), {0, object.medium, object.eta});
    single.prepare(lit.lighting, lit.meshes);
    const Diffusion& d = body.diffusion();
    Shading::Input input{lit.scene, lit.meshes, lit.lighting, {}, camera, {size, 1}};
    input.surfaces = {{0,
                       {&d.surface(0), &d.surface(1)},
                       {&d.surface_gamma(0), &d.surface_gamma(1)},
                       body.domain().frame,
                       nullptr,
                       &single}};
    return Shading(context).shade(input);
  }

  static Camera camera_at(glm::dvec3 eye, float y_fov) {
    Camera camera;
    camera.to_world = glm::mat4(look_at(eye, {0, 0, 0}, {0, 1, 0.01}));
    camera.y_fov = y_fov;
    return camera;
  }

  static constexpr double irradiance = lamp_radiance * 4 / (lamp_distance * lamp_distance);  // across its way

  /// Towards `to_eye` from a half space whose normal is +z.
  static double half_space(double albedo, double g, double eta, glm::dvec3 towards, glm::dvec3 to_eye) {
    const auto inside = [&](glm::dvec3 w) { return glm::dvec3(w.x / eta, w.y / eta, refracted_cosine(w.z, eta)); };
    const glm::dvec3 light = inside(towards), view = inside(to_eye);
    return albedo * henyey_greenstein(g, -glm::dot(light, view)) * fresnel_transmittance(towards.z, eta) *
           fresnel_transmittance(to_eye.z, eta) / (eta * eta) * irradiance * towards.z / (light.z + view.z);
  }

  void expect_half_space(const Medium& medium, glm::dvec3 albedo, int channels, double within) {
    const double eta = 1.4;
    const glm::dvec3 towards = glm::normalize(glm::dvec3(0.5, 0.3, 1)), eye(-6, 2, 9);
    const LitScene lit(context, lit_scene(box({4, 4, 2}, 4), medium, eta, towards), {1, 0, 512});
    const ShadedPicture shaded = shade(lit, camera_at(eye, 0.05f), {8, 6}, 24, channels);
    const char* const names[] = {"single.R", "single.G", "single.B"};
    for (int c = 0; c < 3; ++c) {
      double mean = 0;
      for (float v : shaded.picture.channels.at(names[c])) mean += v / 48.0;
      const double nearer = lamp_distance / glm::distance(lamp_distance * towards, eye / eye.z);
      const double exact = nearer * nearer * half_space(albedo[c], medium.g, eta, towards, glm::normalize(eye));
      std::printf("%s %.5f, exact %.5f\n", names[c], mean, exact);
      EXPECT_NEAR(mean / exact, 1, within);
    }
  }
};

Medium uniform(glm::dvec3 sigma_t, glm::dvec3 albedo, double g) {
  Medium medium;
  medium.g = g;
  medium.homogeneous = {sigma_t * albedo, sigma_t * (1.0 - albedo)};
  return medium;
}

/// Layers along z over the box [-2, 2]^2 x [-1, 1].
Medium layers(const std::vector<float>& sigma_t, float albedo, double g) {
  Medium medium;
  medium.g = g;
  auto density = std::make_shared<Grid>(), share = std::make_shared<Grid>();
  density->size = {1, 1, static_cast<int>(sigma_t.size())};
  density->values = sigma_t;
  density->trilinear = false;
  share->size = {1, 1, 1};
  share->values = {albedo};
  medium.sigma_t = density;
  medium.albedo = share;
  medium.world_to_box = translation({0.5, 0.5, 0.5}) * scaling({0.25, 0.25, 0.5});
  return medium;
}

TEST_F(ShadingSingle, BelowAPlane) {
  const glm::dvec3 albedo(0.95, 0.8, 0.5);
  expect_half_space(uniform({20, 8, 12}, albedo, 0), albedo, 3, 1e-3);
}
TEST_F(ShadingSingle, BelowAPlaneWithForwardScattering) {
  const glm::dvec3 albedo(0.9, 0.7, 0.99);
  expect_half_space(uniform({40, 30, 60}, albedo, 0.6), albedo, 3, 1e-3);
}
// Marched through cells, a medium that is the same everywhere looks as it does without.
TEST_F(ShadingSingle, MarchedThroughTheSameEverywhere) {
  expect_half_space(layers({10, 10}, 0.9f, 0.3), glm::dvec3(0.9), 1, 1e-3);
}
// Only optical depth counts: layers of one albedo are as bright as one medium. 12 layers, two cells each.
TEST_F(ShadingSingle, LayersOfOneAlbedo) {
  expect_half_space(layers({4, 20, 4, 20, 4, 20, 10, 10, 6, 12, 12, 3}, 0.9f, 0), glm::dvec3(0.9), 1, 0.02);
}

/// The layer on a convex object by brute force: sums along the refracted view ray, straight ways to the samples.
double twin(const Scene& scene, const LightSamples& lights, glm::dvec3 eye, glm::dvec3 ray) {
  const Object& object = scene.objects[0];
  const double eta = object.eta, g = object.medium.g, sigma_s = object.medium.homogeneous.sigma_s.g,
               sigma_t = sigma_s + object.medium.homogeneous.sigma_a.g;
  const auto normal_at = [&](const Seen& s) {
    const auto corner = [&](int i) { return glm::dvec3(object.mesh.positions[s.triangle[i]]); };
    return glm::normalize(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
  };
  const Seen seen = nearest_hit(scene, eye, ray);
  if (seen.object != 0) return 0;
  const glm::dvec3 n = normal_at(seen), x = eye + seen.distance * ray;
  const double cosine = -glm::dot(n, ray), mu = refracted_cosine(cosine, eta);
  const glm::dvec3 inwards = glm::normalize((cosine * n + ray) / eta - mu * n);
  const double end = std::min(nearest_hit(scene, x, inwards, 1, 1e-6).distance, 14 / sigma_t);
  constexpr int steps = 150;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double s = end * (i + 0.5) / steps;
    const glm::dvec3 p = x + s * inwards;
    for (const LightSample& light : lights.area) {
      const glm::dvec3 way = glm::dvec3(light.position) - p, w = glm::normalize(way);
      const Seen out = nearest_hit(scene, p, w, 1, 1e-9);
      const glm::dvec3 m = normal_at(out);
      const double cos_in = glm::dot(m, w), mu_in = refracted_cosine(cos_in, eta);
      const glm::dvec3 inside = glm::normalize(w / eta + (mu_in - cos_in / eta) * m);
      const double E = glm::dvec3(light.intensity).g * -glm::dot(glm::dvec3(light.normal), w) / glm::dot(way, way);
      sum += end / steps * sigma_s * henyey_greenstein(g, glm::dot(inside, inwards)) * E *
             fresnel_transmittance(cos_in, eta) * cos_in / mu_in *
             std::exp(-sigma_t * (s + out.distance * cos_in / mu_in));
    }
  }
  return sum * fresnel_transmittance(cosine, eta) / (eta * eta);
}

TEST_F(ShadingSingle, OnABallEqualsTheIntegral) {
  // Where the light grazes a ball of few mean free paths its way is no line of the depth: 8 places instead of 4 halve
  // that.
  for (const auto& [eta, g, sigma_t, within] : {std::tuple{1.0, 0.0, 5.0, 0.1}, std::tuple{1.4, 0.3, 20.0, 0.02}}) {
    const Medium medium = uniform(glm::dvec3(sigma_t), glm::dvec3(0.9), g);
    const glm::dvec3 eye(1.5, 2, 5);
    const glm::ivec2 size(16, 12);
    const Camera camera = camera_at(eye, 0.36f);
    const LitScene lit(context, lit_scene(icosphere(2), medium, eta, glm::normalize(glm::dvec3(1, 0.2, 0.6))),
                       {1, 0, 512});
    const Picture picture = shade(lit, camera, size, 16, 1).picture;
    double square = 0, norm = 0, bias = 0, all = 0;
    for (int i = 0; i < size.x * size.y; ++i) {
      const double tangent = std::tan(0.5 * camera.y_fov);
      const glm::dvec2 at = (2.0 * (glm::dvec2(i % size.x, i / size.x) + 0.5) / glm::dvec2(size) - 1.0) *
                            glm::dvec2(tangent * size.x / size.y, -tangent);
      const glm::dvec3 ray = glm::normalize(glm::dvec3(glm::dmat4(camera.to_world) * glm::dvec4(at, -1, 0)));
      const double exact = twin(lit.scene, lit.lighting.samples(), eye, ray),
                   found = picture.channels.at("single.G")[static_cast<std::size_t>(i)];
      square += (found - exact) * (found - exact), norm += exact * exact, bias += found - exact, all += exact;
    }
    std::printf("eta %.1f: relative L2 %.4f, bias %+.4f\n", eta, std::sqrt(square / norm), bias / all);
    EXPECT_GT(all, 1);
    EXPECT_LT(std::sqrt(square / norm), within);
    EXPECT_LT(std::abs(bias / all), 0.01);
  }
}

// Facets: flux by the table for each light, and what is taken out of Gamma_s.
TEST_F(ShadingSingle, FluxOfTheFacetsEqualsItsSum) {
  const double eta = 1.3, g = 0.4;
  const glm::dvec3 albedo(0.95, 0.7, 0.4), sigma_t(30, 40, 20);
  const Medium medium = uniform(sigma_t, albedo, g);
  const LitScene lit(context, lit_scene(icosphere(3), medium, eta, {0, 0, 1}), {1, 0, 512});
  Body body(context, lit.scene.objects[0].mesh, 16, field_of(medium), 3, eta);
  SingleScattering single(context, body.domain(), body.diffusion(), {0, medium, eta});
  single.prepare(lit.lighting, lit.meshes);
  const std::vector<glm::vec3> gamma_before(2 * body.cut_cells().size(), glm::vec3(0.9f));
  const gpu::Buffer gamma_s = gpu::make_buffer(context, gamma_before, "gamma_s");
  gpu::Commands commands(context);
  single.record_take(commands, gamma_s);
  commands.submit();
  const auto flux = gpu::download<glm::vec4>(context, single.flux());
  const auto gamma = gpu::download<glm::vec3>(context, gamma_s),
             query = gpu::download<glm::vec3>(context, single.query_gamma()),
             entered = gpu::download<glm::vec3>(context, single.entered());
  const double A = boundary_constant(internal_diffuse_reflectance(eta));
  const LightSample& lamp = lit.lighting.samples().area.at(0);
  const GridFrame& frame = body.domain().frame;
  int lit_sides = 0;
  for (std::size_t i = 2; i < flux.size(); ++i) {
    const GpuFacet& side = body.cut_cells()[i / 2].side[i % 2];
    if (side.area < 0.01) continue;
    for (int c = 0; c < 3; ++c) {
      const double reduced_s = (1 - g) * albedo[c] * sigma_t[c], sigma_a = (1 - albedo[c]) * sigma_t[c];
      const double rest = gamma_beside_single(0.9, double(flux[i][c]), 1 / (3 * (reduced_s + sigma_a)), sigma_a, A);
      EXPECT_NEAR(gamma[i][c], rest, 1e-5);
      EXPECT_NEAR(query[i][c], rest - A * flux[i][c], 1e-5);
      EXPECT_NEAR(entered[i][c], rest + flux[i][c], 1e-5);
    }
    const glm::vec3 middle = frame.origin + frame.h * (glm::vec3(body.cut_cells()[i / 2].cell) + side.centre);
    const glm::dvec3 way(lamp.position - middle), towards = glm::normalize(way);
    const double cosine = glm::dot(glm::normalize(glm::dvec3(side.area_vector)), towards);
    if (cosine < 0.3) continue;
    ++lit_sides;
    const double entering = lamp.intensity.r * point_transfer(cosine, 1.0, glm::dot(way, way), eta);
    for (int c = 0; c < 3; ++c) {
      const double exact =
          single.scale()[c] * entering * albedo[c] * single_scattering_share(refracted_cosine(cosine, eta), eta, g);
      EXPECT_NEAR(flux[i][c] / exact, 1, 3e-3);
    }
  }
  EXPECT_GT(lit_sides, 50);
}

}  // namespace
}  // namespace alabaster

// Every transport on wide plates against exact plane-parallel transport: reflectance and transmittance for a beam at
// normal incidence and their sum for diffuse light by adding-doubling (iadpython 0.5.3; g = 0, the surface's own
// reflection taken out), and the radiance of thick plates by Chandrasekhar's H function.
#include <algorithm>
#include <cmath>

#include "pipeline/render.h"
#include "scene/shapes.h"
#include "shared/optics.h"
#include "support/device.h"

namespace alabaster {
namespace {

struct Slab {
  double eta, albedo, thickness;                       // index, sigma_s / sigma_t, mean free paths
  double reflected = 0, transmitted = 0, diffuse = 0;  // of a beam at normal incidence; both, of diffuse light
};

constexpr Slab slabs[] = {
    {1.0, 0.999, 10, 0.838876, 0.138246, 0.871043 + 0.109652},
    {1.0, 0.99, 5, 0.680078, 0.220628, 0.737507 + 0.173152},
    {1.5, 0.99, 5, 0.554673 - 0.04, 0.254555, 0.589031 + 0.231499 - 0.091778},
};

/// H(1) of isotropic scattering (Chandrasekhar, Radiative Transfer, 1950) from 1 / H(mu) =
/// sqrt(1 - a) + (a / 2) integral mu' H(mu') / (mu + mu') dmu'.
double h_function(double albedo) {
  constexpr int n = 400;
  std::vector<double> h(n, 1.0), next(n);
  for (int round = 0; round < 300; ++round) {
    for (int i = 0; i < n; ++i) {
      double sum = 0;
      for (int j = 0; j < n; ++j) sum += (j + 0.5) / (i + j + 1.0) * h[j] / n;
      next[i] = 1 / (std::sqrt(1 - albedo) + 0.5 * albedo * sum);
    }
    for (int i = 0; i < n; ++i) h[i] = 0.5 * (h[i] + next[i]);
  }
  return 1.5 * h[n - 1] - 0.5 * h[n - 2];
}

class TransportSlabs : public GpuTest {
 protected:
  static constexpr double depth = 0.01, lamp_edge = 0.2, lamp_distance = 20, lamp_radiance = 1e4;  // m, W/m^2/sr

  enum class Side { lit, dark };

  static Scene plate_scene(const Slab& slab, Side side, bool lamp) {
    Scene scene;
    scene.path = "plate";
    Object plate;
    plate.name = "plate";
    plate.role = Role::translucent;
    plate.mesh = box({float(8 * depth), float(8 * depth), float(depth)}, 8);
    plate.eta = slab.eta;
    const double sigma_t = slab.thickness / depth;
    plate.medium.homogeneous.sigma_s = glm::dvec3(slab.albedo * sigma_t);
    plate.medium.homogeneous.sigma_a = glm::dvec3((1 - slab.albedo) * sigma_t);
    scene.objects = {plate};
    Camera camera;
    camera.to_world = glm::mat4(look_at({0, 0, side == Side::lit ? 0.3 : -0.3}, {0, 0, 0}));
    camera.y_fov = 0.1f;  // 30 mm
    scene.cameras = {camera};
    if (!lamp) {
      scene.environment.radiance = glm::vec3(1);
      return scene;
    }
    Object light;
    light.name = "lamp";
    light.role = Role::emissive;
    light.mesh = transformed(quad(float(lamp_edge), float(lamp_edge)),
                             glm::dmat4(look_at({0, 0, lamp_distance}, {0, 0, 0})) * rotation({1, 0, 0}, -90));
    light.radiance = glm::vec3(float(lamp_radiance));
    scene.objects.push_back(light);
    return scene;
  }

  /// pi times the radiance at normal view in the plate's middle (the median: some pixels may see the lamp straight
  /// through), over the irradiance.
  double radiance_factor(const Slab& slab, Side side, bool lamp, Transport transport, int grid) {
    const Scene scene = plate_scene(slab, side, lamp);
    Request request;
    request.size = {8, 8};
    request.grid = grid;
    request.transport = transport;
    request.light_samples = 1;
    request.components = {{Component::multiple}};  // single scattering in it
    const RenderResult r = render_scene(context, scene, make_plan(scene, request, context.info().heap_bytes));
    EXPECT_TRUE(r.objects.at(0).solver.converged);
    EXPECT_LT(r.objects.at(0).energy.imbalance(), 1e-5);
    std::vector<float> values = r.shaded.picture.channels.at("multiple.G");
    std::nth_element(values.begin(), values.begin() + 32, values.end());
    const double distance = lamp_distance - depth / 2;
    const double irradiance = lamp ? lamp_radiance * lamp_edge * lamp_edge / (distance * distance) : M_PI;
    return M_PI * values[32] / irradiance;
  }

  /// Flux that leaves over the flux that arrives, where light leaves diffusely.
  double leaves(const Slab& slab, Side side, bool lamp, Transport transport, int grid) {
    return radiance_factor(slab, side, lamp, transport, grid) * f_dt(slab) * slab.eta * slab.eta /
           fresnel_transmittance(1.0, slab.eta);
  }
  static double f_dt(const Slab& slab) { return 1 - internal_diffuse_reflectance(slab.eta); }

  /// Share of a beam that passes without having been scattered.
  static double goes_straight(const Slab& slab, double cosine) {
    return std::pow(fresnel_transmittance(cosine, slab.eta), 2) *
           std::exp(-slab.thickness / refracted_cosine(cosine, slab.eta));
  }

  void compare(Transport transport) {
    for (const Slab& slab : slabs) {
      // Unscattered light never joins the beam transport's diffuse field: it is seen straight through.
      const bool beam = transport == Transport::beam;
      const double straight = beam ? goes_straight(slab, 1) : 0;
      double straight_diffuse = 0;
      for (int i = 0; i < 1000 && beam; ++i) {
        const double mu = (i + 0.5) / 1000;
        straight_diffuse += 2 * mu * goes_straight(slab, mu) / 1000;
      }
      const double as_flux = f_dt(slab) * slab.eta * slab.eta / fresnel_transmittance(1.0, slab.eta);
      const double reflected = leaves(slab, Side::lit, true, transport, 64) / slab.reflected,
                   transmitted = leaves(slab, Side::dark, true, transport, 64) / (slab.transmitted - straight),
                   diffuse = (leaves(slab, Side::lit, false, transport, 64) - as_flux * straight) /
                             (slab.diffuse - straight_diffuse);
      std::printf("eta %.1f albedo %.3f depth %2.0f: R %.3f T %.3f diffuse %.3f of exact\n", slab.eta, slab.albedo,
                  slab.thickness, reflected, transmitted, diffuse);
      EXPECT_NEAR(reflected, 1, 0.01);
      EXPECT_NEAR(transmitted, 1, 0.02);
      EXPECT_NEAR(diffuse, 1, 0.01);
    }
  }
};

TEST_F(TransportSlabs, Directional) { compare(Transport::directional); }
TEST_F(TransportSlabs, Beam) { compare(Transport::beam); }

// 0.3 cells a mean free path, 2.9 cells the plate.
TEST_F(TransportSlabs, BeamDoesNotDependOnTheGrid) {
  for (Side side : {Side::lit, Side::dark}) {
    const double coarse = leaves(slabs[0], side, true, Transport::beam, 24),
                 exact = side == Side::lit ? slabs[0].reflected : slabs[0].transmitted;
    std::printf("24 cells: %.4f of exact\n", coarse / exact);
    EXPECT_NEAR(coarse / exact, 1, 0.01);
  }
}

// What leaves a half space at normal view, lit at normal incidence: albedo H(1)^2 / 8.
TEST_F(TransportSlabs, GatherAtNormalView) {
  for (const Slab& slab : {Slab{1.0, 0.999, 60}, Slab{1.0, 0.9, 10}}) {
    const double exact = slab.albedo * std::pow(h_function(slab.albedo), 2) / 8;
    const double found = radiance_factor(slab, Side::lit, true, Transport::gather, 64) / exact,
                 beam = radiance_factor(slab, Side::lit, true, Transport::beam, 64) / exact;
    std::printf("albedo %.3f, %2.0f deep: gather %.3f, beam %.3f of exact\n", slab.albedo, slab.thickness, found, beam);
    EXPECT_NEAR(found, 1, 0.04);
  }
}

// A lamp behind a plate that scatters nothing: (1 - R)^2 x / (1 - R^2 x^2) of its radiance, x = exp(-sigma_a d / mu').
TEST_F(TransportSlabs, LampsAreSeenStraightThrough) {
  const double tau = 0.7;
  for (double eta : {1.0, 1.5})
    for (double cosine : {1.0, 0.6}) {
      Scene scene = plate_scene({eta, 1e-6, tau}, Side::lit, false);
      scene.environment.radiance = glm::vec3(0);
      Object lamp;
      lamp.name = "lamp";
      lamp.role = Role::emissive;
      lamp.mesh = transformed(quad(2, 2), translation({0, 0, -0.1}) * rotation({1, 0, 0}, 90));
      lamp.radiance = {1, 2, 3};
      scene.objects.push_back(lamp);
      scene.cameras[0].to_world =
          glm::mat4(look_at({0.3 * std::sqrt(1 - cosine * cosine), 0, 0.3 * cosine}, {0, 0, 0}));
      Request request;
      request.size = {8, 8};
      request.grid = 48;
      request.transport = Transport::beam;
      request.light_samples = 8;
      const RenderResult r = render_scene(context, scene, make_plan(scene, request, context.info().heap_bytes));
      const double R = fresnel_reflectance(cosine, eta), x = std::exp(-tau / refracted_cosine(cosine, eta)),
                   exact = (1 - R) * (1 - R) * x / (1 - R * R * x * x);
      for (int c = 0; c < 3; ++c) {
        double sum = 0;
        for (float v : r.shaded.picture.channels.at(std::string("multiple.") + "RGB"[c])) sum += v / (8 * 8);
        EXPECT_NEAR(sum / (c + 1) / exact, 1, 5e-3) << "eta " << eta << " cosine " << cosine;
      }
    }
}

}  // namespace
}  // namespace alabaster

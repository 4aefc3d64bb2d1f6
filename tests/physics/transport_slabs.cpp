// Every transport on wide plates against exact plane-parallel transport: reflectance and transmittance for a beam at normal
// incidence, and their sum for diffuse light. Exact values by adding-doubling (iadpython 0.5.3; g = 0, the surface's own
// reflection taken out).
#include <cmath>
#include <map>

#include "pipeline/render.h"
#include "scene/shapes.h"
#include "shared/optics.h"
#include "support/device.h"

namespace alabaster {
namespace {

struct Slab {
  double eta, albedo, thickness;  // index, sigma_s / sigma_t, mean free paths
  double reflected, transmitted;  // of a beam at normal incidence, without the surface's own reflection
  double diffuse;                 // reflected and transmitted of diffuse light, the same
};

constexpr Slab slabs[] = {
    {1.0, 0.999, 10, 0.838876, 0.138246, 0.871043 + 0.109652},
    {1.0, 0.99, 5, 0.680078, 0.220628, 0.737507 + 0.173152},
    {1.0, 0.99, 2, 0.497489, 0.465699, 0.588000 + 0.373347},
    {1.0, 0.9, 5, 0.412541, 0.076650, 0.476338 + 0.053421},
    {1.5, 0.999, 10, 0.749377 - 0.04, 0.204941, 0.769896 + 0.187703 - 0.091778},
    {1.5, 0.99, 5, 0.554673 - 0.04, 0.254555, 0.589031 + 0.231499 - 0.091778},
    {1.5, 0.99, 2, 0.446540 - 0.04, 0.470081, 0.494228 + 0.423976 - 0.091778},
    {1.5, 0.9, 5, 0.259938 - 0.04, 0.058122, 0.307893 + 0.049231 - 0.091778},
};

class TransportSlabs : public GpuTest {
 protected:
  static constexpr double depth = 0.01, lamp_edge = 0.2, lamp_distance = 20, lamp_radiance = 1e4;  // m, W/m^2/sr

  struct Measured {
    double reflected = 0, transmitted = 0, diffuse = 0, imbalance = 0;
  };

  Scene plate_scene(const Slab& slab) {
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
    for (double side : {1.0, -1.0}) {
      Camera camera;
      camera.name = side > 0 ? "lit" : "dark";
      camera.to_world = glm::mat4(look_at({0, 0, side * 0.3}, {0, 0, 0}));
      camera.y_fov = 0.1f;  // 30 mm
      scene.cameras.push_back(camera);
    }
    return scene;
  }

  /// Flux that leaves the plate's middle over the flux that arrives, by the diffuse shape of the exit: radiance at normal view.
  double leaves(const Scene& scene, const char* camera, Transport transport, int grid, double irradiance, Measured& m) {
    Request request;
    request.size = {16, 16};
    request.grid = grid;
    request.transport = transport;
    request.camera = camera;
    request.light_samples = 1;
    const RenderResult r = render_scene(context, scene, make_plan(scene, request, context.info().heap_bytes));
    EXPECT_TRUE(r.objects.at(0).solver.converged);
    m.imbalance = std::max(m.imbalance, r.objects.at(0).energy.imbalance());
    double sum = 0;
    for (float v : r.shaded.picture.channels.at("multiple.G")) sum += v / (16 * 16);
    const double eta = scene.objects[0].eta, f_dt = 1 - internal_diffuse_reflectance(eta);
    return sum * f_dt * M_PI * eta * eta / fresnel_transmittance(1.0, eta) / irradiance;
  }

  Measured measure(const Slab& slab, Transport transport, int grid) {
    Measured m;
    Scene scene = plate_scene(slab);
    Object lamp;
    lamp.name = "lamp";
    lamp.role = Role::emissive;
    lamp.mesh = transformed(quad(float(lamp_edge), float(lamp_edge)),
                            glm::dmat4(look_at({0, 0, lamp_distance}, {0, 0, 0})) * rotation({1, 0, 0}, -90));
    lamp.radiance = glm::vec3(float(lamp_radiance));
    scene.objects.push_back(lamp);
    const double irradiance = lamp_radiance * lamp_edge * lamp_edge / std::pow(lamp_distance - depth / 2, 2);
    m.reflected = leaves(scene, "lit", transport, grid, irradiance, m);
    m.transmitted = leaves(scene, "dark", transport, grid, irradiance, m);
    scene.objects.pop_back();
    scene.environment.radiance = glm::vec3(1);
    m.diffuse = leaves(scene, "lit", transport, grid, M_PI, m);
    return m;
  }

  void compare(Transport transport, int grid) {
    for (const Slab& slab : slabs) {
      const Measured m = measure(slab, transport, grid);
      // The beam transport's unscattered light never joins the diffuse field.
      const double straight = transport == Transport::beam ? std::pow(fresnel_transmittance(1.0, slab.eta), 2) * std::exp(-slab.thickness) : 0;
      std::printf("eta %.1f albedo %.3f depth %2.0f: R %.3f T %.3f diffuse %.3f of exact, imbalance %.1e\n", slab.eta, slab.albedo, slab.thickness,
                  m.reflected / slab.reflected, m.transmitted / (slab.transmitted - straight), m.diffuse / slab.diffuse, m.imbalance);
    }
  }
};

TEST_F(TransportSlabs, Report) { compare(Transport::report, 64); }
TEST_F(TransportSlabs, Directional) { compare(Transport::directional, 64); }
TEST_F(TransportSlabs, Beam) { compare(Transport::beam, 64); }
TEST_F(TransportSlabs, Gather) { compare(Transport::gather, 64); }
TEST_F(TransportSlabs, BeamCoarse) { compare(Transport::beam, 24); }

}  // namespace
}  // namespace alabaster

// A plate about as thick as a cell, askew in the grid and lit from behind: the fluence on its dark side against the
// slab's closed form, and without the grid's pattern. Both sheets lie in one cell here and in two there.
#include <cmath>
#include <vector>

#include "pipeline/render.h"
#include "scene/shapes.h"
#include "shared/optics.h"
#include "support/device.h"

namespace alabaster {
namespace {

class ThinPlate : public GpuTest {
 protected:
  static constexpr double sigma_s = 2000, thickness = 0.002, eta = 1.3, lamp_radiance = 1e4, lamp_edge = 0.1,
                          lamp_distance = 5;

  Scene plate_scene(glm::dvec3 sigma_a = glm::dvec3(0)) {
    const glm::dmat4 turn = rotation({0, 1, 0}, 20) * rotation({1, 0, 0}, 7);
    Scene scene;
    scene.path = "plate";
    Object plate;
    plate.name = "plate";
    plate.role = Role::translucent;
    plate.mesh = transformed(box({0.08f, 0.1f, static_cast<float>(thickness)}, 8), turn);
    plate.eta = eta;
    plate.medium.homogeneous = {glm::dvec3(sigma_s), sigma_a};
    Object lamp;
    lamp.name = "lamp";
    lamp.role = Role::emissive;
    const glm::dmat4 at(look_at({0, 0, -lamp_distance}, {0, 0, 0}));
    lamp.mesh = transformed(quad(float(lamp_edge), float(lamp_edge)), turn * at * rotation({1, 0, 0}, -90));
    lamp.radiance = glm::vec3(static_cast<float>(lamp_radiance));
    scene.objects = {plate, lamp};
    Camera camera;
    camera.to_world = glm::mat4(turn) * look_at({0, 0, 0.3}, {0, 0, 0});
    camera.y_fov = 0.2f;  // the plate's middle, 60 mm high
    scene.cameras.push_back(camera);
    return scene;
  }

  /// phi + 2 A kappa d_n phi = q at the lit face, = 0 at the dark one; cosh and sinh between, straight without
  /// absorption.
  static double dark_side_fluence(double sigma_a = 0) {
    const double f_dr = internal_diffuse_reflectance(eta), A = boundary_constant(f_dr),
                 kappa = 1 / (3 * (sigma_s + sigma_a));
    const double flux = reduced_intensity(sigma_a, sigma_s) * fresnel_transmittance(1.0, eta) * lamp_radiance *
                        lamp_edge * lamp_edge / (lamp_distance * lamp_distance);
    const double q = dsbc_source(flux, 1 - f_dr);
    if (sigma_a == 0) return q * 2 * A / (4 * A + thickness / kappa);
    const double l = std::sqrt(kappa / sigma_a), e = 2 * A * kappa / l;
    // From the dark face inwards phi = a (cosh(x/l) + sinh(x/l) / e); at the lit face phi + 2 A kappa phi' = q.
    return q / (2 * std::cosh(thickness / l) + (1 / e + e) * std::sinh(thickness / l));
  }

  struct Evenness {
    double mean, spread, worst;  // of the dark side's fluence over the slab's
  };
  static Evenness evenness(const RenderResult& result, char channel, double expected) {
    double sum = 0, squares = 0, worst = 0;
    const std::vector<float>& fluence = result.shaded.picture.channels.at(std::string("fluence.") + channel);
    for (float value : fluence) {
      const double ratio = value / expected;
      sum += ratio, squares += ratio * ratio;
      worst = std::max(worst, std::abs(ratio - 1));
    }
    const double n = double(fluence.size()), mean = sum / n;
    return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean)), worst};
  }
  RenderResult rendered(const Scene& scene, int grid) {
    Request request;
    request.size = {80, 80};
    request.grid = grid;
    return render_scene(context, scene, make_plan(scene, request, context.info().heap_bytes));
  }
};

TEST_F(ThinPlate, DarkSideIsTheSlabsAndEven) {
  const Scene scene = plate_scene();
  struct Case {
    int grid;
    double mean, spread;  // tolerances
  };
  for (const auto& [grid, mean_within, spread_within] :
       {Case{24, 0.06, 0.08}, Case{40, 0.025, 0.03}, Case{64, 0.005, 0.005}}) {
    const RenderResult result = rendered(scene, grid);
    ASSERT_TRUE(result.objects.at(0).solver.converged);
    const auto [mean, spread, worst] = evenness(result, 'G', dark_side_fluence());
    std::printf("grid %d: mean %.4f of the slab's, spread %.4f, worst %.4f\n", grid, mean, spread, worst);
    EXPECT_NEAR(mean, 1, mean_within) << "grid " << grid;  // 0.5, 0.8 and 1.3 cells thick
    EXPECT_LT(spread, spread_within) << "grid " << grid;
  }
}

// A leaf whose diffusion length is 2, 4 and 1.3 cells of the grid of 64, the plate 1.3 cells thick. One unknown stands
// for both sheets in places, and takes phi'' d^2 / 2 of the thickness d for nothing: the dark side is too dark there by
// up to an eighth of (h / l)^2, and the user is told. Where every cell has one sheet it is not.
TEST_F(ThinPlate, AnAbsorbingPlateIsTheSlabsOrTheUserIsTold) {
  const glm::dvec3 sigma_a(16, 4, 40);
  struct Case {
    int grid;
    double mean[3], spread[3];  // tolerances
    bool warned;
  };
  for (const Case& c : {Case{64, {0.04, 0.01, 0.09}, {0.03, 0.01, 0.08}, true},
                        Case{96, {0.015, 0.005, 0.03}, {0.01, 0.003, 0.025}, false}}) {
    const RenderResult result = rendered(plate_scene(sigma_a), c.grid);
    ASSERT_TRUE(result.objects.at(0).solver.converged);
    for (int i = 0; i < 3; ++i) {
      const auto [mean, spread, worst] = evenness(result, "RGB"[i], dark_side_fluence(sigma_a[i]));
      std::printf("grid %d, sigma_a %g: mean %.4f of the slab's, spread %.4f, worst %.4f\n", c.grid, sigma_a[i], mean,
                  spread, worst);
      EXPECT_NEAR(mean, 1, c.mean[i]);
      EXPECT_LT(spread, c.spread[i]);
    }
    bool warned = false;
    for (const std::string& warning : result.warnings)
      warned = warned || warning.find("use a finer --grid") != std::string::npos;
    EXPECT_EQ(warned, c.warned) << c.grid;
  }
}

}  // namespace
}  // namespace alabaster

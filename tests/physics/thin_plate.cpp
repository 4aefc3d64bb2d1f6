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

  Scene plate_scene() {
    const glm::dmat4 turn = rotation({0, 1, 0}, 20) * rotation({1, 0, 0}, 7);
    Scene scene;
    scene.path = "plate";
    Object plate;
    plate.name = "plate";
    plate.role = Role::translucent;
    plate.mesh = transformed(box({0.08f, 0.1f, static_cast<float>(thickness)}, 8), turn);
    plate.eta = eta;
    plate.medium.homogeneous.sigma_s = glm::dvec3(sigma_s);
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

  /// phi + 2 A kappa d_n phi = q at the lit face, = 0 at the dark one, phi linear between.
  static double dark_side_fluence() {
    const double f_dr = internal_diffuse_reflectance(eta), A = boundary_constant(f_dr), kappa = 1 / (3 * sigma_s);
    const double flux =
        fresnel_transmittance(1.0, eta) * lamp_radiance * lamp_edge * lamp_edge / (lamp_distance * lamp_distance);
    return dsbc_source(flux, 1 - f_dr) * 2 * A / (4 * A + thickness / kappa);
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
    Request request;
    request.size = {80, 80};
    request.grid = grid;
    const RenderResult result = render_scene(context, scene, make_plan(scene, request, context.info().heap_bytes));
    ASSERT_TRUE(result.objects.at(0).solver.converged);
    double sum = 0, squares = 0, worst = 0;
    const std::vector<float>& fluence = result.shaded.picture.channels.at("fluence.G");
    for (float value : fluence) {
      const double ratio = value / dark_side_fluence();
      sum += ratio, squares += ratio * ratio;
      worst = std::max(worst, std::abs(ratio - 1));
    }
    const double n = double(fluence.size()), mean = sum / n,
                 spread = std::sqrt(std::max(0.0, squares / n - mean * mean));
    std::printf("grid %d: mean %.4f of the slab's, spread %.4f, worst %.4f\n", grid, mean, spread, worst);
    EXPECT_NEAR(mean, 1, mean_within) << "grid " << grid;  // 0.5, 0.8 and 1.3 cells thick
    EXPECT_LT(spread, spread_within) << "grid " << grid;
  }
}

}  // namespace
}  // namespace alabaster

// The depth down to which light below a facet is seen at the facet alone (BEAM_SKIN_DEPTH, shared/beam.h), chosen on
// balls under a lamp: the gather's single scattering against the report's, which follows rays to the lamp and hardly
// depends on the grid. ALABASTER_STUDY=1 tries more of everything (nine minutes).
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "shading/gather_exit.h"
#include "shading/shading.h"
#include "support/diffusion_device.h"
#include "support/furnace.h"
#include "support/lit_scene.h"

namespace alabaster {
namespace {

class GatherSkin : public GpuTest {
 protected:
  static constexpr double albedo = 0.95;
  static constexpr int samples = 16, edge = 4;
  const glm::ivec2 size{48, 36};

  static Scene ball_under_lamp(double across, double eta, bool behind) {
    Scene scene;
    scene.path = "test";
    scene.objects = {
        make_object(Role::translucent, icosphere(5)),
        make_light(transformed(quad(2, 2),
                               glm::dmat4(look_at(behind ? glm::dvec3(2, 4, -5) : glm::dvec3(-4, 5, 5), {0, 0, 0})) *
                                   rotation({1, 0, 0}, -90)),
                   glm::vec3(10))};
    Object& ball = scene.objects[0];
    ball.name = "ball";
    ball.eta = eta;
    ball.medium.homogeneous = {glm::dvec3(0.5 * across * albedo), glm::dvec3(0.5 * across * (1 - albedo))};
    Camera camera;
    camera.to_world = glm::mat4(look_at({0.5, 2, 5}, {0, 0, 0}));
    camera.y_fov = 0.45f;
    scene.cameras = {camera};
    return scene;
  }

  Picture by_rays(const Scene& scene, int grid) {
    Request request;
    request.grid = grid;
    request.size = size;
    request.transport = Transport::report;
    request.components = std::set<Component>{Component::multiple, Component::single, Component::surface};
    request.light_samples = samples;
    return render_scene(context, scene, make_plan(scene, request, context.info().heap_bytes)).shaded.picture;
  }

  /// RMSE of the gather's layer over its mean, for each skin.
  std::vector<double> errors(int grid, const Scene& scene, const std::vector<float>& skins) {
    const Picture rays = by_rays(scene, grid);
    const Object& ball = scene.objects[0];
    const double sigma_a = ball.medium.homogeneous.sigma_a.x, sigma_t = ball.medium.homogeneous.sigma_s.x + sigma_a;
    const LitScene lit(context, scene, {samples, 0, 512});
    Body body(context, ball.mesh, grid, uniform_medium(1 / (3 * sigma_t), sigma_a), 1, ball.eta);
    body.solve(glm::vec3(0));  // the rest of the picture does not matter
    const Diffusion& d = body.diffusion();
    Scene unmirrored = scene;  // the gather knows the index by itself
    unmirrored.objects[0].eta = 1;
    std::vector<double> result;
    for (const float skin : skins) {
      BeamSource beam(context, body.domain(), mesh_starts(ball.mesh, body.domain().frame, body.cut_cells()), 1, skin);
      GatherExit gather(context, body.domain(), d, beam, lit.meshes.rays, ball.eta);
      gpu::Commands commands(context);
      beam.record(commands, lit.lighting, {d.kappa(), d.absorption(), d.facet_medium(), d.kappa_scale(), 1}, ball.eta);
      commands.submit();
      gather.update();
      Shading::Input input{unmirrored, lit.meshes, lit.lighting, {}, scene.cameras[0], {size, edge}};
      input.surfaces = {{0,
                         {&d.surface(0), &d.surface(1)},
                         {&d.surface_gamma(0), &d.surface_gamma(1)},
                         body.domain().frame,
                         &gather}};
      const Picture picture = Shading(context).shade(input).picture;
      double square = 0, sum = 0, pixels = 0;
      for (int i = 0; i < size.x * size.y; ++i) {
        if (rays.channels.at("object.Y")[i] < 0.999f) continue;
        const double truth = rays.channels.at("single.G")[i];
        square += std::pow(picture.channels.at("single.G")[i] - truth, 2), sum += truth, ++pixels;
      }
      EXPECT_GT(pixels, 500);
      result.push_back(std::sqrt(square / pixels) / (sum / pixels));
    }
    return result;
  }
};

TEST_F(GatherSkin, NoOtherDepthIsMuchBetterOnBalls) {
  const bool study = std::getenv("ALABASTER_STUDY") != nullptr;
  const std::vector<float> skins = study
                                       ? std::vector<float>{0.05f, 0.1f, 0.15f, 0.2f, 0.25f, 0.3f, 0.375f, 0.5f, 0.75f}
                                       : std::vector<float>{0.1f, float(BEAM_SKIN_DEPTH), 0.4f, 0.75f};
  const std::vector<int> grids = study ? std::vector<int>{16, 32, 64} : std::vector<int>{32, 64};
  const std::vector<double> sizes = study ? std::vector<double>{10, 20, 40} : std::vector<double>{20};
  const std::vector<double> etas = study ? std::vector<double>{1, 1.3, 1.5} : std::vector<double>{1};
  std::printf("| eta | lit from | grid | mean free paths across |");
  for (float skin : skins) std::printf(" %.3g |", skin);
  std::vector<double> logs(skins.size());
  int rows = 0;
  for (const double eta : etas)
    for (const bool behind : {false, true})
      for (const int grid : grids)
        for (const double across : sizes) {
          std::printf("\n| %.1f | %s | %d | %g |", eta, behind ? "behind" : "the front", grid, across);
          const std::vector<double> row = errors(grid, ball_under_lamp(across, eta, behind), skins);
          for (std::size_t k = 0; k < row.size(); ++k) {
            std::printf(" %.1f |", 100 * row[k]);
            logs[k] += std::log(row[k]);
          }
          ++rows;
        }
  std::printf("\n| geometric mean | | | |");
  double best = INFINITY, chosen = INFINITY;
  for (std::size_t k = 0; k < skins.size(); ++k) {
    const double mean = std::exp(logs[k] / rows);
    std::printf(" %.2f |", 100 * mean);
    best = std::min(best, mean);
    if (skins[k] == float(BEAM_SKIN_DEPTH)) chosen = mean;
  }
  std::printf("  (RMSE of the mean, %%)\n");
  EXPECT_LT(chosen, 1.05 * best);
}

}  // namespace
}  // namespace alabaster

// Gamma_s of the cells' facets or of the pixel in the surface query: which comes nearer to the path tracer? A study,
// run by
//   test_physics --gtest_filter='GammaPlace.DISABLED_Table' --gtest_also_run_disabled_tests
#include <filesystem>

#include "pipeline/render.h"
#include "reference/reference.h"
#include "scene/demo_scenes.h"
#include "scene/shapes.h"
#include "shared/optics.h"
#include "support/lit_scene.h"

namespace alabaster {
namespace {

constexpr glm::ivec2 size{80, 60};

/// A stone box under a small lamp, a blade above it whose shadow's edge falls across its top.
Scene sharp_edge(double paths, double albedo) {
  Scene scene;
  scene.path = "sharp edge";
  Object stone = make_object(Role::translucent, transformed(box({0.1f, 0.05f, 0.1f}, 4), translation({0, 0.025, 0})));
  stone.eta = 1.3;
  stone.medium.homogeneous = {glm::dvec3(paths / 0.1 * albedo), glm::dvec3(paths / 0.1 * (1 - albedo))};
  Object blade = make_object(Role::opaque, transformed(box({0.08f, 0.002f, 0.2f}), translation({-0.045, 0.09, 0})));
  blade.albedo = glm::vec3(0);
  const glm::dmat4 down = translation({0.02, 0.6, 0}) * rotation({1, 0, 0}, 180);
  scene.objects = {stone, blade, make_light(transformed(quad(0.01f, 0.01f), down), glm::vec3(2000))};
  scene.cameras = {{"main", look_at({0.12, 0.26, 0.16}, {0, 0.03, 0}), 0.5f}};
  return scene;
}

class GammaPlace : public GpuTest {
 protected:
  /// Pixels that are the object's throughout.
  static bool whole(const Picture& p, std::size_t i) { return p.channels.at("object.Y")[i] > 0.999f; }

  /// Gamma_s at the point in the middle of each pixel, of the green channel.
  std::vector<double> at_pixels(const Scene& scene, const Plan& plan, const Picture& picture) {
    const LitScene lit(context, scene, {plan.light_samples, plan.environment_samples, plan.shadow_map_size});
    const Camera& camera = scene.cameras.front();
    const double tangent = std::tan(0.5 * camera.y_fov);
    std::vector<Receiver> receivers;
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const std::size_t i = static_cast<std::size_t>(y * size.x + x);
        const glm::dvec2 screen = 2.0 * glm::dvec2(x + 0.5, y + 0.5) / glm::dvec2(size) - 1.0;
        const glm::dvec3 ray =
            glm::dmat3(camera.to_world) * glm::dvec3(screen.x * tangent * size.x / size.y, -screen.y * tangent, -1);
        const auto plane = [&](const char* name) { return picture.channels.at(name)[i]; };
        const glm::vec3 normal(plane("N.X"), plane("N.Y"), plane("N.Z"));
        receivers.push_back({glm::vec3(camera.to_world[3]) + plane("Z") * glm::vec3(glm::normalize(ray)),
                             glm::length(normal) > 0 ? glm::normalize(normal) : glm::vec3(0, 1, 0), 0});
      }
    const Object& object = scene.objects.front();
    const Coefficients& c = object.medium.homogeneous;
    const double left = reduced_intensity(c.sigma_a.g, c.sigma_s.g * (1 - object.medium.g));
    std::vector<double> gamma;
    for (const glm::vec3& flux : lit.gather(receivers, object.eta)) gamma.push_back(left * static_cast<double>(flux.g));
    return gamma;
  }

  /// Relative RMSE, the reference's noise taken out, with `share` of Gamma_s from the pixel and the rest from the
  /// facets.
  double error(const Scene& scene, const Picture& p, const std::vector<double>& pixel, double share, const Picture& r) {
    const double eta = scene.objects.front().eta, f_dr = internal_diffuse_reflectance(eta), A = boundary_constant(f_dr);
    const Camera& camera = scene.cameras.front();
    const double tangent = std::tan(0.5 * camera.y_fov);
    double square = 0, mean = 0, n = 0;
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const std::size_t i = static_cast<std::size_t>(y * size.x + x);
        if (!whole(p, i) || !whole(r, i)) continue;
        const auto plane = [&](const Picture& q, const char* name) {
          return static_cast<double>(q.channels.at(name)[i]);
        };
        const glm::dvec2 screen = 2.0 * glm::dvec2(x + 0.5, y + 0.5) / glm::dvec2(size) - 1.0;
        const glm::dvec3 ray = glm::normalize(
            glm::dmat3(camera.to_world) * glm::dvec3(screen.x * tangent * size.x / size.y, -screen.y * tangent, -1));
        const glm::dvec3 normal(plane(p, "N.X"), plane(p, "N.Y"), plane(p, "N.Z"));
        const double f_t = fresnel_transmittance(-glm::dot(ray, normal), eta);
        const double gamma = share * pixel[i] + (1 - share) * plane(p, "gamma_s.G");
        const double t = query_radiance(std::max(0.0, query_bracket(plane(p, "fluence.G"), gamma, A, 1 - f_dr)), f_t,
                                        1 / (eta * eta));
        const double truth = plane(r, "multiple.G") + plane(r, "single.G");
        square += (t - truth) * (t - truth) - plane(r, "variance.subsurface.G");
        mean += truth;
        ++n;
      }
    return std::sqrt(std::max(0.0, square / n)) / (mean / n);
  }

  void table(const std::string& name, const Scene& scene, int samples) {
    ReferenceOptions options;
    options.width = size.x, options.height = size.y, options.samples = samples;
    const Picture reference = render_reference(scene, options);
    for (int grid : {32, 64, 128}) {
      Request request;
      request.grid = grid;
      request.size = size;
      const Plan plan = make_plan(scene, request, context.info().heap_bytes);
      const Picture p = render_scene(context, scene, plan).shaded.picture;
      const std::vector<double> pixel = at_pixels(scene, plan, p);
      std::printf("| %s | %d | %.1f | %.1f | %.1f |\n", name.c_str(), grid, 100 * error(scene, p, pixel, 0, reference),
                  100 * error(scene, p, pixel, 0.5, reference), 100 * error(scene, p, pixel, 1, reference));
      std::fflush(stdout);
    }
  }
};

TEST_F(GammaPlace, DISABLED_Table) {
  std::printf("| scene | grid | facets %% | half and half %% | pixel %% |\n| --- | --- | --- | --- | --- |\n");
  table("sharp edge, 50 mean free paths, albedo 0.99", sharp_edge(50, 0.99), 256);
  table("sharp edge, 200 mean free paths, albedo 0.9", sharp_edge(200, 0.9), 256);
  table("sharp edge, 1000 mean free paths, albedo 0.9", sharp_edge(1000, 0.9), 256);
  if (std::filesystem::exists(std::string(ALABASTER_MESHES) + "/bunny00.off"))
    table("bunny, 50 mean free paths, albedo 0.99", demo_scene("bunny-50mfp-0.99-1.3", ALABASTER_MESHES), 64);
}

}  // namespace
}  // namespace alabaster

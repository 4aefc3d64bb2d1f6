// The whole renderer in the furnace. Convex objects must come out exact, pixel by pixel; concave ones miss the light
// that their own surface sends them (theory: not carried by the report's model), and what they miss is reported here.
#include "support/furnace.h"

#include <filesystem>

#include "scene/off.h"
#include "support/device.h"

namespace alabaster {
namespace {

class Furnace : public GpuTest {
 protected:
  test::FurnaceResult render(const Mesh& mesh, double eta, Transport transport = Transport::report, double g = 0) {
    const Scene scene = test::furnace_scene(mesh, eta, g);
    Request request;
    request.grid = 32;
    request.size = {160, 120};
    request.transport = transport;
    const RenderResult result = render_scene(context, scene, make_plan(scene, request, context.info().heap_bytes));
    EXPECT_TRUE(result.objects.at(0).solver.converged) << result.objects.at(0).solver.reason;
    EXPECT_LE(result.objects.at(0).energy.imbalance(), 1e-4);
    EXPECT_EQ(result.shaded.negative_pixels, 0u);
    return test::furnace_figures(result.shaded.picture);
  }

  void expect_exact(const Mesh& mesh) {
    for (double eta : {1.0, 1.3, 1.5}) {
      const test::FurnaceResult r = render(mesh, eta);
      EXPECT_GT(r.pixels, 3 * 1000u);
      EXPECT_NEAR(r.mean, 1, 1e-3) << "eta " << eta;
      EXPECT_LE(r.worst, 5e-3) << "eta " << eta;
      RecordProperty("eta " + std::to_string(eta),
                     "mean " + std::to_string(r.mean) + " worst " + std::to_string(r.worst));
      std::printf("eta %.1f: mean %.5f, worst pixel %.5f off\n", eta, r.mean, r.worst);
    }
  }
};

TEST_F(Furnace, Sphere) { expect_exact(icosphere(5)); }
TEST_F(Furnace, Ellipsoid) { expect_exact(ellipsoid(5, {1, 0.6f, 0.8f})); }
TEST_F(Furnace, Box) { expect_exact(transformed(box({1, 0.7f, 0.8f}), rotation({1, 2, 0.5}, 35))); }

// Directional: exact as the report. Beams: the flux is exact and so is the mean over a sphere; pixels show how evenly
// the beams are laid down. Gather: the mean is as exact as the quadrature of the facets' level; its worst pixel is at
// the silhouette at eta 1.
TEST_F(Furnace, TransportsOnASphere) {
  struct Tolerance {
    Transport transport;
    double mean, worst;
  };
  for (const auto& [transport, mean_within, worst_within] :
       {Tolerance{Transport::directional, 1e-3, 1e-2}, Tolerance{Transport::beam, 2e-3, 3e-2},
        Tolerance{Transport::gather, 1e-2, 0.2}})
    for (double eta : {1.0, 1.5}) {
      const test::FurnaceResult r = render(icosphere(4), eta, transport);
      std::printf("%s eta %.1f: mean %.5f, worst pixel %.5f off\n", name_of(transport), eta, r.mean, r.worst);
      EXPECT_NEAR(r.mean, 1, mean_within) << name_of(transport) << " eta " << eta;
      EXPECT_LE(r.worst, worst_within) << name_of(transport) << " eta " << eta;
    }
}

TEST_F(Furnace, DirectionalOnABox) {
  for (double eta : {1.0, 1.5}) {
    const test::FurnaceResult r =
        render(transformed(box({1, 0.7f, 0.8f}), rotation({1, 2, 0.5}, 35)), eta, Transport::directional);
    std::printf("eta %.1f: mean %.5f, worst pixel %.5f off\n", eta, r.mean, r.worst);
    EXPECT_NEAR(r.mean, 1, 1e-3);
    EXPECT_LE(r.worst, 1e-2);
  }
}

TEST_F(Furnace, AnisotropicScatteringAndLessDenseInside) {
  EXPECT_NEAR(render(icosphere(4), 1.3, Transport::report, 0.8).mean, 1, 1e-3);
  EXPECT_NEAR(render(icosphere(4), 0.8).mean, 1, 1e-3);
}

TEST_F(Furnace, AsPrintedIsTooBrightByEtaSquared) {
  // Transmitted light alone carries the factor: at eta the mean is R + eta^2 (1 - R), R the mean mirrored share seen.
  for (double eta : {1.3, 1.5}) {
    const Scene scene = test::furnace_scene(icosphere(4), eta);
    Request request;
    request.grid = 32;
    request.size = {80, 60};
    const auto transmitted = [&](Transport transport) {
      request.transport = transport;
      const RenderResult r = render_scene(context, scene, make_plan(scene, request, context.info().heap_bytes));
      double sum = 0;
      for (float v : r.shaded.picture.channels.at("multiple.G")) sum += v;
      return sum;
    };
    EXPECT_NEAR(transmitted(Transport::as_printed) / transmitted(Transport::report), eta * eta, 1e-3 * eta * eta);
    EXPECT_GT(render(icosphere(4), eta, Transport::as_printed).mean, 1 + 0.8 * (eta * eta - 1));
  }
}

TEST_F(Furnace, ConcaveObjectsMissTheirOwnLight) {
  for (double eta : {1.0, 1.5}) {
    const test::FurnaceResult r = render(torus(1, 0.4f, 96, 48), eta);
    std::printf("torus, eta %.1f: mean %.4f, worst pixel %.4f off\n", eta, r.mean, r.worst);
    EXPECT_LT(r.mean, 0.9995);  // it is there ...
    EXPECT_GT(r.mean, 0.9);     // ... and it is all that is missing
  }
}

TEST_F(Furnace, BunnyMissesItsOwnLight) {
  const std::string path = std::string(ALABASTER_MESHES) + "/bunny00.off";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there; third_party/fetch-meshes brings it";
  Mesh mesh = read_off(path);
  const float scale = 2 / bounds_of(mesh).size().y;
  for (double eta : {1.0, 1.5}) {
    const test::FurnaceResult r = render(transformed(mesh, scaling(glm::dvec3(scale))), eta);
    std::printf("bunny, eta %.1f: mean %.4f, worst pixel %.4f off\n", eta, r.mean, r.worst);
    EXPECT_LT(r.mean, 0.9995);
    EXPECT_GT(r.mean, 0.85);
  }
}

}  // namespace
}  // namespace alabaster

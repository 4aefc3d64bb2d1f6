// The whole renderer in the furnace: every object must come out exact, pixel by pixel; concave ones and neighbours by
// the light that surfaces send each other.
#include "support/furnace.h"

#include <filesystem>

#include "scene/off.h"
#include "support/device.h"

namespace alabaster {
namespace {

class Furnace : public GpuTest {
 protected:
  std::optional<int> interreflections;
  int grid = 32;
  glm::ivec2 size{160, 120};

  test::FurnaceResult render(const Mesh& mesh, double eta, Transport transport = Transport::report, double g = 0) {
    return render(test::furnace_scene(mesh, eta, g), transport);
  }

  test::FurnaceResult render(const Scene& scene, Transport transport = Transport::report) {
    Request request;
    request.grid = grid;
    request.size = size;
    request.transport = transport;
    request.interreflections = interreflections;
    const RenderResult result = render_scene(context, scene, make_plan(scene, request, context.info().heap_bytes));
    for (const ObjectReport& object : result.objects) {
      EXPECT_TRUE(object.solver.converged) << object.solver.reason;
      EXPECT_LE(object.energy.imbalance(), 1e-4);
    }
    EXPECT_EQ(result.shaded.negative_pixels, 0u);
    return test::furnace_figures(result.shaded.picture);
  }

  /// Two units tall; nothing where the mesh has not been fetched.
  static Mesh bunny() {
    const std::string path = std::string(ALABASTER_MESHES) + "/bunny00.off";
    if (!std::filesystem::exists(path)) return {};
    Mesh mesh = read_off(path);
    const float scale = 2 / bounds_of(mesh).size().y;
    return transformed(mesh, scaling(glm::dvec3(scale)));
  }

  /// A ball and a box of another medium beside it.
  static Scene neighbours(double eta) {
    Scene scene = test::furnace_scene(transformed(icosphere(4), translation({-1.05, 0, 0})), eta);
    Object other = scene.objects[0];
    other.mesh = transformed(box({1.6f, 1.8f, 1.7f}), translation({1, 0, 0}) * rotation({0, 1, 0}, 20));
    other.eta = 1.2;
    other.medium.homogeneous.sigma_s = glm::dvec3(35);
    scene.objects.push_back(other);
    scene.cameras[0].to_world = look_at({0.5, 2, 6}, {0, 0, 0});
    return scene;
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

// Directional: exact as the report. Beams: the flux is exact and so is the mean over a sphere; but what was scattered
// leaves diffusely, at a silhouette, too, and at eta 1 one sees straight through there. Gather: the mean is as exact as
// the quadrature of the facets' level, and the silhouette by what the ray gathers and what it sees behind.
TEST_F(Furnace, TransportsOnASphere) {
  struct Tolerance {
    Transport transport;
    double mean, worst;
  };
  for (const auto& [transport, mean_within, worst_within] :
       {Tolerance{Transport::directional, 1e-3, 1e-2}, Tolerance{Transport::beam, 2e-3, 0.2},
        Tolerance{Transport::gather, 5e-3, 0.1}})
    for (double eta : {1.0, 1.5}) {
      const test::FurnaceResult r = render(icosphere(4), eta, transport);
      std::printf("%s eta %.1f: mean %.5f, worst pixel %.5f off\n", name_of(transport), eta, r.mean, r.worst);
      EXPECT_NEAR(r.mean, 1, mean_within) << name_of(transport) << " eta " << eta;
      EXPECT_LE(r.worst, eta == 1 ? worst_within : std::min(worst_within, 0.015))
          << name_of(transport) << " eta " << eta;
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

// Without it a concave object misses the light that its own surface sends it ...
TEST_F(Furnace, WithoutInterreflectionsConcaveObjectsMissTheirOwnLight) {
  interreflections = 0;
  for (double eta : {1.0, 1.5}) {
    const test::FurnaceResult r = render(torus(1, 0.4f, 96, 48), eta);
    std::printf("torus, eta %.1f: mean %.4f, worst pixel %.4f off\n", eta, r.mean, r.worst);
    EXPECT_LT(r.mean, 0.97);
    EXPECT_GT(r.mean, 0.9);
  }
}

// ... and with it nothing is missing.
TEST_F(Furnace, ConcaveObjectsLightThemselves) {
  expect_exact(torus(1, 0.4f, 64, 32));
  EXPECT_NEAR(render(torus(1, 0.4f, 64, 32), 0.8).mean, 1, 1e-3);
}

TEST_F(Furnace, BunnyLightsItself) {
  const Mesh mesh = bunny();
  if (mesh.triangles.empty()) GTEST_SKIP() << "no bunny; third_party/fetch-meshes brings it";
  expect_exact(mesh);
}

TEST_F(Furnace, ObjectsLightEachOther) {
  for (double eta : {1.0, 1.5}) {
    const test::FurnaceResult r = render(neighbours(eta));
    std::printf("ball and box, eta %.1f: mean %.4f, worst pixel %.4f off\n", eta, r.mean, r.worst);
    EXPECT_NEAR(r.mean, 1, 1e-3);
    EXPECT_LE(r.worst, 5e-3);
  }
}

Scene absorbing_torus(int segments, glm::vec3 sky) {
  Scene scene = test::furnace_scene(torus(1, 0.4f, segments, segments / 2), 1.3);
  scene.objects[0].medium.homogeneous.sigma_a = {0.1, 0.5, 2};
  scene.environment.radiance = sky;
  return scene;
}

Object lamp() {
  Object lamp;
  lamp.role = Role::emissive;
  lamp.mesh = transformed(quad(1, 1), translation({0.3, 4, 0.2}) * rotation({1, 0, 0}, 180));
  lamp.radiance = {5, 5, 5};
  return lamp;
}

// With absorption and a lamp: what enters is absorbed or leaves for good, and few passes say what they leave out.
TEST_F(Furnace, EnergyBalancesWithLightThatEntersAgain) {
  Scene scene = absorbing_torus(96, {0, 0, 0});
  scene.objects.push_back(lamp());
  Request request;
  request.grid = 32;
  request.size = {32, 24};
  std::vector<double> under_way;
  for (int passes : {1, 3, 12}) {
    request.interreflections = passes;
    const RenderResult r = render_scene(context, scene, make_plan(scene, request, context.info().heap_bytes));
    under_way.push_back(r.exchange.under_way);
    const ObjectReport& object = r.objects.at(0);
    EXPECT_GT(object.reentered.r, 0.01 * object.energy.in.r);
    EXPECT_GT(object.reentered.r, object.reentered.b);
    EXPECT_LE(object.energy.imbalance(), passes == 12 ? 1e-4 : r.exchange.under_way + 1e-5);
  }
  EXPECT_LT(under_way[2], 1e-4);
  for (int i = 0; i < 2; ++i) EXPECT_LT(under_way[i + 1], 0.25 * under_way[i]);
}

// Every transport brings in light between surfaces. Directional: exact as the report. Beams: pixels show where the
// surface is bent within a cell, and silhouettes at eta 1.
class FurnaceOfTransport : public Furnace, public ::testing::WithParamInterface<Transport> {
 protected:
  FurnaceOfTransport() { grid = 24, size = {96, 72}; }
  void expect_mean(const char* what, const Scene& scene) {
    const test::FurnaceResult r = render(scene, GetParam());
    std::printf("%s, %s, eta %.1f: mean %.5f, worst pixel %.4f off\n", what, name_of(GetParam()), scene.objects[0].eta,
                r.mean, r.worst);
    const bool directional = GetParam() == Transport::directional;
    EXPECT_NEAR(r.mean, 1, directional ? 1e-3 : 0.01) << what << " eta " << scene.objects[0].eta;
    if (directional) {
      EXPECT_LE(r.worst, 5e-3) << what << " eta " << scene.objects[0].eta;
    }
  }
};

TEST_P(FurnaceOfTransport, Torus) {
  for (double eta : {1.0, 1.3, 1.5}) expect_mean("torus", test::furnace_scene(torus(1, 0.4f, 64, 32), eta));
}

TEST_P(FurnaceOfTransport, Box) {
  for (double eta : {1.0, 1.5})
    expect_mean("box", test::furnace_scene(transformed(box({1, 0.7f, 0.8f}), rotation({1, 2, 0.5}, 35)), eta));
}

TEST_P(FurnaceOfTransport, Bunny) {
  const Mesh mesh = bunny();
  if (mesh.triangles.empty()) GTEST_SKIP() << "no bunny; third_party/fetch-meshes brings it";
  for (double eta : {1.0, 1.5}) expect_mean("bunny", test::furnace_scene(mesh, eta));
}

TEST_P(FurnaceOfTransport, Neighbours) {
  for (double eta : {1.0, 1.5}) expect_mean("ball and box", neighbours(eta));
}

INSTANTIATE_TEST_SUITE_P(All, FurnaceOfTransport,
                         ::testing::Values(Transport::directional, Transport::beam, Transport::gather),
                         [](const auto& test) { return name_of(test.param); });

// As above for all light at once: a lamp, a sky, a neighbour and a grey floor.
TEST_P(FurnaceOfTransport, EnergyBalancesWithLightThatEntersAgain) {
  Scene scene = absorbing_torus(64, {0.2f, 0.1f, 0.3f});
  Object ball = scene.objects[0];
  ball.mesh = transformed(icosphere(3, 0.4f), translation({0.2, 0.8, 0.1}));
  ball.eta = 1.1;
  ball.medium.homogeneous.sigma_s = glm::dvec3(6);
  scene.objects.push_back(ball);
  Object floor;
  floor.role = Role::opaque;
  floor.mesh = transformed(quad(6, 6), translation({0, -0.8, 0}));
  floor.albedo = {0.5f, 0.4f, 0.3f};
  scene.objects.push_back(floor);
  scene.objects.push_back(lamp());
  Request request;
  request.transport = GetParam();
  request.grid = 16;
  request.size = {32, 24};
  std::vector<double> under_way;
  for (int passes : {2, 20}) {
    request.interreflections = passes;
    const RenderResult r = render_scene(context, scene, make_plan(scene, request, context.info().heap_bytes));
    under_way.push_back(r.exchange.under_way);
    double all = 0, out = 0;  // of both objects, green
    for (const ObjectReport& object : r.objects) {
      EXPECT_GT(object.reentered.r, 0.01 * object.energy.in.r);
      all += object.energy.in.g;
      out += object.energy.in.g - object.energy.absorbed.g - object.energy.out.g;
    }
    EXPECT_GT(r.objects[0].reentered.r, r.objects[0].reentered.b);
    std::printf("%s, %d passes: under way %.1e, energy %.1e\n", name_of(GetParam()), passes, r.exchange.under_way,
                out / all);
    EXPECT_LE(std::abs(out / all), r.exchange.under_way + 1e-5);
  }
  EXPECT_GT(under_way[0], 1e-4);
  EXPECT_LT(under_way[1], 3e-5);
}

TEST_F(Furnace, ConvexObjectsPayNothing) {
  const Scene scene = test::furnace_scene(ellipsoid(4, {1, 0.6f, 0.8f}), 1.3);
  Request request;
  request.grid = 24;
  request.size = {64, 48};
  const RenderResult usual = render_scene(context, scene, make_plan(scene, request, context.info().heap_bytes));
  request.interreflections = 0;
  const RenderResult without = render_scene(context, scene, make_plan(scene, request, context.info().heap_bytes));
  EXPECT_EQ(usual.stages.count("links"), 0u);
  EXPECT_EQ(usual.exchange.counts.rays, 0u);
  for (const char* channel : {"R", "G", "B"})
    EXPECT_TRUE(usual.shaded.picture.channels.at(channel) == without.shaded.picture.channels.at(channel));
}

}  // namespace
}  // namespace alabaster

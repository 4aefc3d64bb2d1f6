// Light from a picture of the environment, in the path tracer: closed forms for a sun, and against chance.
#include "physics/reference_scenes.h"
#include "reference/reference.h"
#include "shared/optics.h"

namespace alabaster {
namespace {
using namespace testing_scenes;

/// One texel shines.
struct Sun {
  glm::ivec2 size, at;
  std::shared_ptr<const EnvironmentPicture> picture;
  explicit Sun(int rows) : size(2 * rows, rows), at(rows * 3 / 5, rows / 4) {
    std::vector<glm::vec3> texels(static_cast<std::size_t>(size.x * size.y), glm::vec3(0));
    texels[static_cast<std::size_t>(at.y * size.x + at.x)] = glm::vec3(4000);
    picture = std::make_shared<EnvironmentPicture>(size, texels);
  }
  /// Integral of radiance times f(direction) over all directions.
  template <class F>
  double integral(F f) const {
    const int n = 32;
    double sum = 0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const double top = std::cos(M_PI * at.y / size.y), bottom = std::cos(M_PI * (at.y + 1) / size.y);
        const double row = std::acos(glm::mix(top, bottom, (j + 0.5) / n)) / M_PI;
        sum += f(picture->direction({(at.x + (i + 0.5) / n) / size.x, row}));
      }
    return 4000 * picture->solid_angle(at.y) * sum / n / n;
  }
};

std::shared_ptr<const EnvironmentPicture> spots() {
  std::vector<glm::vec3> texels(16 * 8, glm::vec3(0.2f, 0.3f, 0.4f));
  texels[2 * 16 + 5] = {20, 15, 10};
  texels[1 * 16 + 11] = {5, 20, 5};
  texels[5 * 16 + 8] = {9, 9, 20};
  return std::make_shared<EnvironmentPicture>(glm::ivec2(16, 8), texels, 0.1f);
}

TEST(ReferenceEnvironment, EvenPictureIsTheUniformEnvironment) {
  Scene scene;
  scene.environment.radiance = {0.5f, 1, 2};
  scene.objects.push_back(translucent(icosphere(2), homogeneous(glm::dvec3(4), glm::dvec3(0.1)), 1.3));
  scene.cameras.push_back(looking_at_origin({0, 1, 4}, 0.6f));
  ReferenceOptions options;
  options.width = options.height = 16;
  options.samples = 8;
  const Picture uniform = render_reference(scene, options);
  scene.environment.picture =
      std::make_shared<EnvironmentPicture>(glm::ivec2(8, 4), std::vector<glm::vec3>(32, scene.environment.radiance));
  scene.environment.radiance = glm::vec3(0);
  EXPECT_EQ(render_reference(scene, options).channels, uniform.channels);
}

// Lambert: albedo / pi times flux times cosine.
TEST(ReferenceEnvironment, SunOnAPlate) {
  const Sun sun(256);
  Scene scene;
  scene.environment.picture = sun.picture;
  scene.objects.push_back(opaque(quad(2, 2), glm::vec3(0.6f)));
  const World world(scene);
  const Estimate e = radiance(world, 20000, 50, [](Random&) { return Ray{{0.1f, 1, 0.2f}, {0, -1, 0}}; });
  const double exact = 0.6 / M_PI * sun.integral([](glm::dvec3 d) { return d.y; });
  std::printf("plate in the sun %.6f +- %.6f, exact %.6f\n", e.mean.x, e.error.x, exact);
  EXPECT_NEAR(e.mean.x, exact, 3 * e.error.x);
  EXPECT_LT(e.error.x, 1e-3 * exact);
}

// Once scattered sunlight of a half space, isotropic: F_t(mu) F_t(mu0) / eta^2 * a / (4 pi) * flux mu0 / (mu' + mu0'),
// primed cosines inside (S. Chandrasekhar, "Radiative Transfer", 1960, with Fresnel's factors at both crossings).
TEST(ReferenceEnvironment, SunScatteredOnceInAHalfSpace) {
  for (double eta : {1.0, 1.3, 1.5}) {
    const Sun sun(eta == 1 ? 256 : 16);
    Scene scene;
    scene.environment.picture = sun.picture;
    scene.objects.push_back(translucent(transformed(box({200, 30, 200}), translation({0, -15, 0})),
                                        homogeneous(glm::dvec3(0.7), glm::dvec3(0.3)), eta));
    const World world(scene, Guiding::always);
    const glm::dvec3 to_eye = glm::normalize(glm::dvec3(0.6, 1, 0.3));
    double first = 0, second = 0;
    const int paths = eta == 1 ? 20000 : 100000;
    for (int i = 0; i < paths; ++i) {
      Random random(6, static_cast<std::uint64_t>(i), 0);
      const PathSample s = trace_path(world, glm::vec3(2.0 * to_eye), -glm::vec3(to_eye), {}, random);
      const double value = static_cast<double>(s.radiance[static_cast<int>(Layer::single)].x);
      first += value;
      second += value * value;
    }
    const double mean = first / paths, error = std::sqrt((second / paths - mean * mean) / paths);
    const double mu = to_eye.y, below = refracted_cosine(mu, eta);
    const double exact =
        fresnel_transmittance(mu, eta) / (eta * eta) * 0.7 / (4 * M_PI) * sun.integral([&](glm::dvec3 d) {
          return fresnel_transmittance(d.y, eta) * d.y / (below + refracted_cosine(d.y, eta));
        });
    std::printf("eta %.1f: %.6f +- %.6f, exact %.6f\n", eta, mean, error, exact);
    EXPECT_NEAR(mean, exact, 3 * error);
    EXPECT_LT(error, 0.02 * exact);
  }
}

// Whether the picture's lights are looked for or met by chance: the same picture, in all layers.
TEST(ReferenceEnvironment, LookingForLightsAgreesWithChance) {
  for (double eta : {1.0, 1.4}) {
    Scene scene;
    scene.environment.picture = spots();
    scene.objects.push_back(translucent(torus(0.6f, 0.3f, 24, 12), homogeneous({6, 4, 2}, {0.1, 0.1, 0.3}, 0.4), eta));
    scene.objects.push_back(emitter(transformed(flipped(quad(1.5, 1.5)), translation({0.5, 1.6, 0})), glm::vec3(3)));
    scene.cameras.push_back(looking_at_origin({0.6, 1.5, 2.6}, 0.5f));
    ReferenceOptions options;
    options.width = options.height = 10;
    options.samples = 3000;
    options.guiding = Guiding::always;
    const Picture looked_for = render_reference(scene, options);
    // At an index of 1.0001, where nothing else changes, lights are met by chance alone.
    if (eta == 1) scene.objects[0].eta = 1.0001;
    options.guiding = Guiding::never;
    options.seed = 1;
    options.samples = 6000;
    const Picture met = render_reference(scene, options);
    expect_equal(looked_for, met, eta == 1 ? "spots, index-matched" : "spots, eta 1.4", 0.09);
    const auto noise = [](const Picture& p) { return std::get<double>(p.attributes.at("noise")); };
    EXPECT_LT(noise(looked_for), noise(met) * std::sqrt(2.0));  // of one sample
  }
}

// The background is the picture, and a mirror shows it mirrored.
TEST(ReferenceEnvironment, IsSeenBehindAndMirrored) {
  const auto picture = spots();
  Scene scene;
  scene.environment.picture = picture;
  scene.objects.push_back(translucent(transformed(box({2, 0.2f, 2}), translation({0, -0.1, 0})),
                                      homogeneous(glm::dvec3(0), glm::dvec3(1e4)), 1.5));
  const World world(scene);
  const glm::vec3 down = glm::normalize(glm::vec3(0.3, -0.7, 0.2)), up = glm::normalize(glm::vec3(0.3, 0.7, 0.2));
  for (int i = 0; i < 4; ++i) {
    Random random(1, static_cast<std::uint64_t>(i), 0);
    const auto surface = static_cast<int>(Layer::surface);
    EXPECT_EQ(trace_path(world, {0, 3, 0}, up, {}, random).radiance[surface], picture->radiance(up));
    const glm::vec3 mirrored = trace_path(world, -0.5f * down, down, {}, random).radiance[surface];
    const float reflectance = 1 - fresnel_transmittance(-down.y, 1.5f);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(mirrored[c], reflectance * picture->radiance(up)[c], 1e-5f);
  }
}

}  // namespace
}  // namespace alabaster

// The render query on the device against the same source in double precision.
#include <random>

#include "shared/optics.h"
#include "support/device.h"

namespace alabaster {
namespace {

class ShadingQuery : public GpuTest {};

TEST_F(ShadingQuery, EqualsDoublePrecision) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<glm::vec4> given, constants;
  const std::vector<double> etas = {0.7, 0.9, 1.0, 1.0001, 1.3, 1.5, 2.4};
  for (int i = 0; i < 4000; ++i) {
    const double eta = etas[i % etas.size()];
    const double f_dr = internal_diffuse_reflectance(eta);
    const double cosine = i < 40 ? i % 2 : uniform(random);  // edges: grazing and straight on
    given.push_back({eta, cosine, 10 * uniform(random), 10 * uniform(random)});
    constants.push_back({boundary_constant(f_dr), 1 - f_dr, 1 / (eta * eta), 0});
  }
  const std::uint32_t n = static_cast<std::uint32_t>(given.size());
  const gpu::Buffer in = gpu::make_buffer(context, given, "given"), c = gpu::make_buffer(context, constants, "surface");
  const gpu::Buffer out(context, n * sizeof(glm::vec3), "result");
  const gpu::Pass pass(context, "test/query.comp");
  gpu::Commands commands(context);
  commands.dispatch(pass, {n, 1, 1}, {{"given", in}, {"constants", c}, {"result", out}}, n);
  commands.submit();
  const std::vector<glm::vec3> result = gpu::download<glm::vec3>(context, out);

  int negative = 0, mirrored = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    const glm::dvec4 g = given[i], k = constants[i];
    const double f_t = fresnel_transmittance(g.y, g.x), bracket = query_bracket(g.z, g.w, k.x, k.y);
    // F_t is steep where total reflection sets in (eta < 1) and at grazing angles when eta is nearly 1.
    const double critical = g.x < 1 ? std::sqrt(1 - g.x * g.x) : -1;
    const double tolerance = std::abs(g.y - critical) < 1e-3          ? 1e-2
                             : std::abs(g.x - 1) < 1e-3 && g.y < 0.02 ? 1e-4
                                                                      : 1e-5;
    EXPECT_NEAR(result[i].x, f_t, tolerance) << g.x << " " << g.y;
    EXPECT_NEAR(result[i].y, bracket, 1e-5 * (g.z + g.w) * 20);
    EXPECT_NEAR(result[i].z, query_radiance(bracket, f_t, k.z), tolerance * (g.z + g.w) * 20);
    negative += bracket < 0;
    mirrored += f_t == 0;
  }
  EXPECT_GT(negative, 100);
  EXPECT_GT(mirrored, 100);
}

}  // namespace
}  // namespace alabaster

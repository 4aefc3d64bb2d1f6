// shared/optics.h as the GPU runs it against the same source in double precision.
#include "shared/optics.h"

#include <random>

#include "support/device.h"

namespace alabaster {
namespace {

struct Values {
  float fresnel, diffuse, reduced, conductance, surface, bracket, radiance;
};

class GpuOptics : public GpuTest {};

TEST_F(GpuOptics, MatchesDoublePrecision) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<glm::vec4> inputs;
  for (float eta : {0.5f, 0.75f, 1.f, 1.0001f, 1.3f, 1.5f, 2.f, 3.f})
    for (float mu : {0.f, 1e-4f, 0.5f, 0.745356f, 1.f}) inputs.push_back({mu, eta, unit(random), unit(random)});
  for (int i = 0; i < 200; ++i)
    inputs.push_back({unit(random), 0.5f + 2 * unit(random), 10 * unit(random), 5 * unit(random)});
  inputs.push_back({0.5f, 1.3f, 0, 0});
  inputs.push_back({0.5f, 1.3f, 1, 0});

  const gpu::Pass pass(context, "test/optics.comp");
  const gpu::Buffer in = gpu::make_buffer(context, inputs, "inputs"),
                    out(context, inputs.size() * sizeof(Values), "outputs");
  gpu::Commands commands(context);
  commands.dispatch(pass, {inputs.size(), 1, 1}, {{"inputs", in}, {"outputs", out}},
                    static_cast<std::uint32_t>(inputs.size()));
  commands.submit();

  const std::vector<Values> results = gpu::download<Values>(context, out);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const glm::dvec4 v(inputs[i]);
    const double f_dr = internal_diffuse_reflectance(v.y), A = boundary_constant(f_dr);
    const double bracket = query_bracket(v.z, v.w, A, 1 - f_dr);
    const Values& r = results[i];
    const std::string where = "mu " + std::to_string(v.x) + " eta " + std::to_string(v.y);
    EXPECT_NEAR(r.fresnel, fresnel_reflectance(v.x, v.y), 2e-4) << where;  // steep at grazing and at the critical angle
    EXPECT_NEAR(r.diffuse, f_dr, 2e-6) << where;
    EXPECT_NEAR(r.reduced, reduced_intensity(v.z, v.w), 1e-6) << where;
    EXPECT_NEAR(r.conductance, dsbc_conductance(A, v.z), 1e-5 * dsbc_conductance(A, v.z)) << where;
    EXPECT_NEAR(r.surface, dsbc_surface_fluence(v.z, v.w, A, v.x), 1e-5 * (1 + v.z + v.w)) << where;
    EXPECT_NEAR(r.bracket, bracket, 1e-4 * (1 + v.z + v.w)) << where;
    EXPECT_NEAR(r.radiance, query_radiance(bracket, 1 - f_dr, 1 / (v.y * v.y)), 1e-5 * (1 + v.z + v.w)) << where;
  }
}

}  // namespace
}  // namespace alabaster

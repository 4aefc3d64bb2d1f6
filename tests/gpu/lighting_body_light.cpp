// lighting/add_source.comp: the transport's own source and light from surfaces, added on every facet; and what a facet
// sees by the links (lighting/arrivals.glsl): what the transport lets in by them is what Exchange leaves out.
#include "lighting/exchange.h"
#include "pipeline/body_light.h"
#include "support/diffusion_device.h"
#include "support/lit_scene.h"

namespace alabaster {
namespace {

class LightingBodyLight : public GpuTest {
 protected:
  static constexpr double eta = 1.4;
  static constexpr int directions = 24;

  /// A torus that a lamp and an environment light.
  static Scene scene() {
    Scene scene = torus_under_lamp(eta);
    scene.environment.radiance = {0.2f, 0.1f, 0.3f};
    return scene;
  }

  const LitScene lit{context, scene(), {8, 0, 256}};
  Body body{context, scene().objects[0].mesh, 20, uniform_medium(0.05, 0.4), 3, eta};

  std::vector<glm::vec3> read(const gpu::Buffer& buffer) { return gpu::download<glm::vec3>(context, buffer); }
};

TEST_F(LightingBodyLight, SumEqualsTwin) {
  for (Transport transport : {Transport::directional, Transport::beam}) {
    BodyLight light(context, transport, scene().objects[0].mesh, body.domain(), body.diffusion(), eta);
    ASSERT_TRUE(light.apart());
    {
      gpu::Commands commands(context);
      light.record_lights(commands, lit.lighting);
      light.record_lamps(commands, lit.lighting);
      commands.submit();
    }
    const FacetLight before = light.light();
    const auto gamma = read(before.gamma_s), query = read(*before.query), entered = read(*before.entered);
    std::vector<glm::vec3> flux(gamma.size());
    for (std::size_t i = 0; i < flux.size(); ++i) flux[i] = {0.1f * float(i % 7), 0.2f * float(i % 3), 1};
    gpu::upload(context, light.facets().flux(), flux);
    gpu::Commands commands(context);
    light.record_surfaces(commands);
    commands.submit();
    const FacetLight after = light.light();
    EXPECT_NE(&after.gamma_s, &before.gamma_s);
    const auto sum = read(after.gamma_s), sum_query = read(*after.query), sum_entered = read(*after.entered);
    const double weakened = reduced_intensity(0.4, 1 / 0.15 - 0.4);  // exp(-sigma_a / sigma_s')
    double worst = 0, largest = 0;
    for (std::size_t i = 2; i < flux.size(); ++i) {
      const glm::dvec3 surfaces = weakened * glm::dvec3(flux[i]);
      worst = std::max(worst, glm::distance(glm::dvec3(sum[i]), glm::dvec3(gamma[i]) + surfaces));
      worst = std::max(worst, glm::distance(glm::dvec3(sum_query[i]), glm::dvec3(query[i]) + surfaces));
      worst = std::max(worst, glm::distance(glm::dvec3(sum_entered[i]), glm::dvec3(entered[i]) + glm::dvec3(flux[i])));
      largest = std::max(largest, glm::length(glm::dvec3(sum[i])));
    }
    EXPECT_GT(largest, 1.5);
    EXPECT_LT(worst, 2e-6 * largest);
  }
}

TEST_F(LightingBodyLight, LightsEnterOnce) {
  // With the report's transport all of the light comes by Exchange. Apart, the same comes in two parts, and what is
  // known of surfaces by the transport.
  BodyLight report(context, Transport::report, scene().objects[0].mesh, body.domain(), body.diffusion(), eta);
  EXPECT_FALSE(report.apart());
  for (const auto& [transport, known] :
       {std::pair{Transport::directional, false}, {Transport::directional, true}, {Transport::beam, true}}) {
    // Without a mesh beams start from the facets, as the report's light does.
    BodyLight light(context, transport, Mesh{}, body.domain(), body.diffusion(), eta);
    {
      gpu::Commands commands(context);
      report.record_lamps(commands, lit.lighting);
      light.record_lamps(commands, lit.lighting);
      commands.submit();
    }
    Exchange whole(context, lit.scene, lit.lighting, {{0, body.domain(), report.facets(), eta}}, {directions}),
        apart(context, lit.scene, lit.lighting, {{0, body.domain(), light.facets(), eta, true}}, {directions});
    for (Exchange* exchange : {&whole, &apart}) {
      std::vector<glm::vec3> sent = gpu::download<glm::vec3>(context, exchange->transmitted());
      for (std::size_t i = 0; i < sent.size(); ++i) sent[i] = {0.3f, 0.01f * float(i % 50), 0.1f};
      gpu::upload(context, exchange->transmitted(), sent);
    }
    if (known) {  // what surfaces send, but for the half that is sent later
      gpu::Commands commands(context);
      light.record_lights_apart(commands, lit.lighting, apart.around(0));
      apart.record_known(commands);
      commands.submit();
      for (Exchange* exchange : {&whole, &apart}) {
        std::vector<glm::vec3> sent = gpu::download<glm::vec3>(context, exchange->transmitted());
        for (std::size_t i = 0; i < sent.size(); ++i) sent[i] *= 1 + 0.1f * float(i % 10);
        gpu::upload(context, exchange->transmitted(), sent);
      }
    }
    gpu::Commands commands(context);
    light.record_lights_apart(commands, lit.lighting, apart.around(0), known);
    whole.record_gather(commands, 0);
    apart.record_gather(commands, 0);
    light.record_surfaces(commands);
    commands.submit();
    const auto all = read(report.facets().flux()), sum = read(*light.light().entered),
               surfaces = read(light.facets().flux());
    const auto links = gpu::download<std::uint32_t>(context, apart.links(0));
    const auto sides = gpu::download<ExchangeSide>(context, apart.sides(0));
    double worst = 0, largest = 0;
    int open_facets = 0, half_open = 0;
    for (std::size_t i = 0; i < sides.size(); ++i) {
      const std::uint32_t entry = sides[i].entry;
      int open = 0;
      for (int k = 0; k < directions; ++k) open += links[k * sides.size() + i] == link_open;
      open_facets += open == directions;
      half_open += open > 0 && open < directions;
      if (open == directions) {
        EXPECT_EQ(surfaces[entry], glm::vec3(0));
      }
      worst = std::max(worst, glm::distance(glm::dvec3(all[entry]), glm::dvec3(sum[entry])));
      largest = std::max(largest, glm::length(glm::dvec3(all[entry])));
    }
    EXPECT_GT(open_facets, 100);
    EXPECT_GT(half_open, 100);
    EXPECT_GT(largest, 1);
    // The lamps' share differs where a sample's cosine is at the horizon only.
    EXPECT_LT(worst, 1e-5 * largest) << name_of(transport);
  }
}

}  // namespace
}  // namespace alabaster

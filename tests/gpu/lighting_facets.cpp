// lighting/facet_receivers.comp and facet_source.comp: Gamma_s on the two sides of each cut cell against the double
// twin's exact sum at the facets' middles.
#include <cmath>

#include "lighting/facet_source.h"
#include "scene/shapes.h"
#include "shared/diffusion.h"
#include "support/lighting_twin.h"
#include "support/lit_scene.h"

namespace alabaster {
namespace {

class LightingFacets : public GpuTest {};

TEST_F(LightingFacets, GammaOfEachSideEqualsTwin) {
  Scene scene;
  Object ball = make_object(Role::translucent, ellipsoid(3, {0.5f, 0.3f, 0.4f}));
  ball.eta = 1.4;
  scene.objects = {
      ball,
      make_light(transformed(quad(0.5f, 0.5f), translation({0.3, 2, 0.2}) * rotation({1, 0, 0}, 180)), {3, 5, 7})};
  scene.environment.radiance = {0.2f, 0.1f, 0.3f};
  const LitScene lit(context, scene, {6, 12, 512});
  const Domain domain = make_domain(context, ball.mesh, choose_frame(bounds_of(ball.mesh), 12));
  const std::vector<GpuCutCell> cuts = gpu::download<GpuCutCell>(context, domain.cut_cells);
  const std::size_t count = domain.summary.cut_cells + 1;
  std::vector<FacetMedium> media(count);
  for (std::size_t i = 0; i < count; ++i) media[i] = {glm::vec3(1), glm::vec3(0.3f, 0.6f, 0.9f) + 1e-3f * float(i % 7)};

  const FacetSource source(context, domain);
  const gpu::Buffer media_buffer = gpu::make_buffer(context, media, "media");
  gpu::Commands commands(context);
  source.record(commands, lit.lighting, media_buffer, ball.eta);
  commands.submit();
  const std::vector<glm::vec3> gamma = gpu::download<glm::vec3>(context, source.gamma_s());

  double largest = 0, worst = 0;
  int sides = 0;
  for (std::size_t i = 1; i < count; ++i)
    for (int s = 0; s < 2; ++s) {
      const GpuFacet& side = cuts[i].side[s];
      if (side.area < 1e-3f) continue;
      const glm::vec3 middle = domain.frame.origin + domain.frame.h * (glm::vec3(cuts[i].cell) + side.centre);
      const double straight = std::min(1.0, double(glm::length(side.area_vector)) / side.area);
      const float slack = float(domain.frame.h * (0.02 + 0.5 * std::sqrt(1 - straight * straight)));
      // The twin looks from where the receiver is lifted to: the ellipsoid is convex, nothing else can shadow it.
      const glm::vec3 normal = glm::normalize(side.area_vector);
      const glm::dvec3 expected =
          glm::dvec3(media[i].reduced_intensity) *
          exact_flux(scene, lit.lighting.samples(), {middle + (slack + 0.02f) * normal, normal, 0}, ball.eta);
      const glm::dvec3 found(gamma[2 * i + std::size_t(s)]);
      largest = std::max(largest, glm::length(expected));
      worst = std::max(worst, glm::distance(expected, found));
      ++sides;
    }
  EXPECT_GT(sides, 100);
  EXPECT_GT(largest, 0.1);
  EXPECT_LT(worst, 0.02 * largest);  // the twin's place differs by the lift, some hundredths of the lamp's distance
}

}  // namespace
}  // namespace alabaster

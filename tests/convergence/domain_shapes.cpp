// Cut cells of the device under refinement. On any grid they hold the mesh's own volume and area, because the integrals
// are exact; so what converges is the mesh to the smooth shape (second order), and, cell by cell, the facets to it.
#include <cmath>
#include <numbers>

#include "domain/domain.h"
#include "scene/shapes.h"
#include "support/device.h"

namespace alabaster {
namespace {

constexpr double pi = std::numbers::pi;

class DomainConvergence : public GpuTest {
 protected:
  DomainMaker maker{context};
  DomainSummary summary(const Mesh& mesh, int n) {
    DomainSummary s = maker.make(mesh, choose_frame(bounds_of(mesh), n)).summary;
    EXPECT_LT(glm::length(s.area_vector), 1e-5 * s.area);
    return s;
  }
};

TEST_F(DomainConvergence, AnyGridHoldsTheMeshVolumeAndArea) {
  Mesh sphere = icosphere(4, 0.3f), ring = transformed(torus(1, 0.4f, 80, 40), rotation({1, 1, 0}, 40));
  Mesh tilted = transformed(box({0.2f, 0.5f, 0.9f}), rotation({1, 2, 3}, 50)), bumpy = icosphere(5, 1);
  for (glm::vec3& p : bumpy.positions) p *= 1 + 0.1f * std::sin(9 * p.x) * std::cos(8 * p.y + p.z);
  for (const Mesh* mesh : {&sphere, &ring, &tilted, &bumpy}) {
    for (int n : {10, 17, 32, 64}) {
      DomainSummary s = summary(*mesh, n);
      EXPECT_NEAR(s.volume / signed_volume(*mesh), 1, 5e-6) << n;
      EXPECT_NEAR(s.area / area(*mesh), 1, 5e-6) << n;
    }
  }
}

TEST_F(DomainConvergence, RefinedMeshesTendToTheSmoothShapesAtSecondOrder) {
  const double R = 1, r = 0.35;
  double last_sphere[2] = {}, last_torus[2] = {};
  for (int level = 2; level <= 4; ++level) {
    DomainSummary sphere = summary(icosphere(level, 1), 32);
    DomainSummary ring = summary(torus(float(R), float(r), 16 << (level - 1), 8 << (level - 1)), 32);
    double sphere_error[] = {1 - sphere.volume / (4 * pi / 3), 1 - sphere.area / (4 * pi)};
    double torus_error[] = {1 - ring.volume / (2 * pi * pi * R * r * r), 1 - ring.area / (4 * pi * pi * R * r)};
    for (int i = 0; i < 2; ++i) {
      if (level > 2) {
        EXPECT_NEAR(last_sphere[i] / sphere_error[i], 4, 0.25);
        EXPECT_NEAR(last_torus[i] / torus_error[i], 4, 0.25);
      }
      last_sphere[i] = sphere_error[i];
      last_torus[i] = torus_error[i];
    }
  }
}

/// Root mean square over a sphere's facets, weighted by area, in radii: how far the facet's centroid lies off the
/// sphere; the error of the depth of the cell's centroid; the error of the mean normal.
struct FacetErrors {
  double position = 0, depth = 0, normal = 0;
};

FacetErrors facet_errors(const Domain& domain, const std::vector<GpuCutCell>& cuts) {
  FacetErrors e;
  double h = domain.frame.h, total = 0;
  for (std::size_t c = 1; c < cuts.size(); ++c) {
    glm::dvec3 corner = glm::dvec3(domain.frame.origin) + h * glm::dvec3(cuts[c].cell);
    glm::dvec3 x = corner + h * glm::dvec3(cuts[c].facet.centre), centre = corner + h * glm::dvec3(cuts[c].centre);
    double S = cuts[c].facet.area, depth = 1 - glm::length(centre);
    glm::dvec3 n = glm::normalize(glm::dvec3(cuts[c].facet.area_vector));
    e.position += S * std::pow(glm::length(x) - 1, 2);
    e.depth += S * std::pow(h * cuts[c].facet.distance - depth, 2);
    e.normal += S * glm::dot(n - glm::normalize(x), n - glm::normalize(x));
    total += S;
  }
  return {std::sqrt(e.position / total), std::sqrt(e.depth / total), std::sqrt(e.normal / total)};
}

TEST_F(DomainConvergence, FacetsOfASphereTendToItAtSecondOrder) {
  Mesh sphere = icosphere(6, 1);
  FacetErrors last;
  for (int n : {12, 24, 48}) {
    Domain domain = maker.make(sphere, choose_frame(bounds_of(sphere), n));
    FacetErrors e = facet_errors(domain, gpu::download<GpuCutCell>(context, domain.cut_cells));
    EXPECT_LT(e.normal, 0.002)
        << n;  // on a sphere the mean normal points through the centroid: the mesh's flats remain
    if (n > 12) {
      EXPECT_GT(last.position / e.position, 3.2);
      EXPECT_GT(last.depth / e.depth, 3.2);
    }
    last = e;
  }
}

}  // namespace
}  // namespace alabaster

// lighting/beam_starts.h: places that stand for all of a facet's surface, with the mesh's own normals.
#include <gtest/gtest.h>

#include "lighting/beam_source.h"
#include "lighting/beam_starts.h"
#include "support/diffusion_device.h"
#include "support/lit_scene.h"

namespace alabaster {
namespace {

class LightingBeamStarts : public GpuTest {};

/// Irradiance times area of parallel light from `towards` on the front of a mesh, m^2.
double lit_area(const Mesh& mesh, glm::dvec3 towards) {
  double sum = 0;
  for (glm::uvec3 t : mesh.triangles) {
    const glm::dvec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
    sum += std::max(0.0, 0.5 * glm::dot(glm::cross(b - a, c - a), towards));
  }
  return sum;
}

TEST_F(LightingBeamStarts, HoldTheFacetsAreaAndTheMeshsNormals) {
  for (const Mesh& mesh : {transformed(box({1, 0.7f, 0.4f}), rotation({1, 2, 3}, 35)), torus(1, 0.4f, 48, 24)}) {
    const Domain domain = make_domain(context, mesh, choose_frame(bounds_of(mesh), 24));
    const auto cuts = gpu::download<GpuCutCell>(context, domain.cut_cells);
    const BeamStarts starts = mesh_starts(mesh, domain.frame, cuts);
    ASSERT_EQ(starts.of.size(), 2 * cuts.size());
    EXPECT_EQ(starts.of[0].y + starts.of[1].y, 0u);
    EXPECT_LE(starts.most, std::uint32_t(BEAM_MOST_STARTS));
    double lit = 0, lit_by_facets = 0;
    const glm::dvec3 towards = glm::normalize(glm::dvec3(1, -2, 0.5));
    for (std::size_t i = 2; i < starts.of.size(); ++i) {
      const GpuFacet& side = cuts[i / 2].side[i % 2];
      double area = 0;
      for (std::uint32_t k = starts.of[i].x; k < starts.of[i].x + starts.of[i].y; ++k) {
        const BeamStart& start = starts.starts[k];
        area += start.area;
        lit += start.area * std::max(0.0, glm::dot(glm::dvec3(start.normal), towards));
        EXPECT_NEAR(glm::length(start.normal), 1, 1e-5);
        for (int axis = 0; axis < 3; ++axis)
          EXPECT_NEAR(start.position[axis], float(cuts[i / 2].cell[axis]) + side.centre[axis], 1.01);
      }
      EXPECT_NEAR(area, side.area, 1e-5 * (side.area + 1e-3)) << i;
      lit_by_facets += std::max(0.0, glm::dot(glm::dvec3(side.area_vector), towards));
    }
    const double h2 = std::pow(double(domain.frame.h), 2), exact = lit_area(mesh, towards);
    EXPECT_NEAR(lit * h2 / exact, 1, 3e-3);  // normals up to 14 degrees off their mean are one
    if (mesh.triangles.size() == 12) {
      EXPECT_LT(lit_by_facets * h2 / exact, 0.99);  // what the box's edges lose by facets' means
    }
  }
}

/// W/m^2 times m^2 that enter a convex mesh from parallel light of 1 W/m^2.
double entering(const Mesh& mesh, glm::dvec3 towards, double eta) {
  double sum = 0;
  for (glm::uvec3 t : mesh.triangles) {
    const glm::dvec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
    const glm::dvec3 area = 0.5 * glm::cross(b - a, c - a);
    const double cosine = glm::dot(glm::normalize(area), towards);
    if (cosine > 0) sum += glm::length(area) * cosine * fresnel_transmittance(cosine, eta);
  }
  return sum;
}

// Edges and all; by the facets' means the edges lose some.
TEST_F(LightingBeamStarts, AllLightEntersABox) {
  const Mesh mesh = transformed(box({1, 0.7f, 0.4f}), rotation({1, 2, 3}, 35));
  const double eta = 1.3;
  const glm::dvec3 towards = glm::normalize(glm::dvec3(1, -2, 0.5));
  Scene scene;
  scene.objects = {make_object(Role::translucent, mesh)};
  scene.objects[0].eta = eta;
  PunctualLight sun;
  sun.kind = PunctualLight::Kind::directional;
  sun.intensity = glm::vec3(1);
  sun.direction = glm::vec3(-towards);
  scene.lights = {sun};
  Body body(context, mesh, 24, uniform_medium(0.02, 0.4), 1, eta);
  const LitScene lit(context, scene, {1, 0, 512});
  const auto entered = [&](const BeamStarts& starts) {
    BeamSource beam(context, body.domain(), starts, 1);
    const Diffusion& d = body.diffusion();
    gpu::Commands commands(context);
    beam.record(commands, lit.lighting, {d.kappa(), d.absorption(), d.facet_medium(), d.kappa_scale(), 1}, eta);
    commands.submit();
    const BeamTotals t = beam.totals();
    EXPECT_NEAR((t.near.x + t.in_cells.x + t.absorbed.x + t.through.x) / t.entered.x, 1, 1e-9);
    return t.entered.x;
  };
  const GridFrame& frame = body.domain().frame;
  const double exact = entering(mesh, towards, eta);
  EXPECT_NEAR(entered(mesh_starts(mesh, frame, body.cut_cells())) / exact, 1, 1e-3);
  EXPECT_LT(entered(facet_starts(frame, body.cut_cells())) / exact, 0.99);
}

}  // namespace
}  // namespace alabaster

// lighting/beam_march.comp and beam_source.comp: what beams lay down is counted to the last unit, and on a ball in
// parallel light it is what the closed form says. lighting/directional_source.comp: against the double-precision sum
// over the samples.
#include <cmath>

#include "lighting/beam_groups.h"
#include "lighting/beam_source.h"
#include "lighting/facet_source.h"
#include "support/beam_twin.h"
#include "support/lit_scene.h"

namespace alabaster {
namespace {

/// Parallel light along -z from far away.
Object far_lamp(glm::vec3 radiance) {
  return make_light(transformed(quad(2, 2), glm::dmat4(look_at({0, 0, 1000}, {0, 0, 0})) * rotation({1, 0, 0}, -90)),
                    radiance);
}

class LightingBeams : public GpuTest {
 protected:
  struct Marched {
    BeamTotals totals;
    std::vector<float> power, seen;  // W, x fastest, [channel][cell]
    std::vector<glm::vec3> gamma_s, query_gamma, entered, through;
    std::vector<glm::vec4> skin;
    glm::dvec3 unit{0};
  };

  Marched march(const Scene& scene, Body& body, int channels, double eta, int samples = 1) {
    const LitScene lit(context, scene, {samples, 16, 512});
    BeamSource beam(context, body.domain(), facet_starts(body.domain().frame, body.cut_cells()), channels);
    const Diffusion& d = body.diffusion();
    gpu::Commands commands(context);
    beam.record(commands, lit.lighting, {d.kappa(), d.absorption(), d.facet_medium(), d.kappa_scale(), channels}, eta);
    commands.submit();
    return {beam.totals(),
            gpu::download<float>(context, beam.power()),
            gpu::download<float>(context, beam.seen()),
            gpu::download<glm::vec3>(context, beam.gamma_s()),
            gpu::download<glm::vec3>(context, beam.query_gamma()),
            gpu::download<glm::vec3>(context, beam.entered()),
            gpu::download<glm::vec3>(context, beam.through()),
            gpu::download<glm::vec4>(context, beam.near()),
            beam_unit(lit.lighting.samples(), body.domain().frame)};
  }

  static Scene ball_scene(const Mesh& mesh, double eta, glm::vec3 radiance) {
    Scene scene;
    Object ball = make_object(Role::translucent, mesh);
    ball.eta = eta;
    scene.objects = {ball, far_lamp(radiance)};
    return scene;
  }
};

TEST_F(LightingBeams, NothingIsLostAndTheOrderDoesNotShow) {
  const Mesh mesh = torus(1, 0.4f, 48, 24);  // beams leave it and mirror inside
  Scene scene = ball_scene(mesh, 1.5, {3e6f, 2e6f, 1e6f});
  scene.environment.radiance = {0.5f, 1, 2};
  const MediumField layered = [](glm::dvec3 p) {
    const glm::dvec3 dense = glm::dvec3(2, 6, 15) * (p.x > 0 ? 3.0 : 1.0);
    return MediumPoint{0.9 * dense, 0.1 * dense};
  };
  Body body(context, mesh, 20, layered, 3, 1.5);
  const Marched a = march(scene, body, 3, 1.5), b = march(scene, body, 3, 1.5);
  const BeamTotals& t = a.totals;
  const std::size_t cells = a.power.size() / 3;
  for (int c = 0; c < 3; ++c) {
    EXPECT_GT(t.near[c], 0);
    EXPECT_GT(t.in_cells[c], 0);
    EXPECT_GT(t.through[c], 0);
    const double left = t.entered[c] - (t.near[c] + t.in_cells[c] + t.absorbed[c] + t.through[c]);
    EXPECT_LT(std::abs(left), 0.5 * a.unit[c]);
    EXPECT_NEAR(t.absorbed[c] / (t.absorbed[c] + t.near[c] + t.in_cells[c]), 0.1, 1e-4);
    double laid = 0, near = 0, entered = 0, through = 0;
    for (std::size_t i = c * cells; i < (c + 1) * cells; ++i) {
      EXPECT_GE(a.seen[i], a.power[i]);
      laid += a.power[i], near += double(a.seen[i]) - a.power[i];
    }
    EXPECT_GT(near, 0.01 * t.near[c]);  // below the skin; most is dense here
    const double h = body.domain().frame.h;
    for (std::size_t i = 2; i < a.skin.size(); ++i) {
      const double area = body.cut_cells()[i / 2].side[i % 2].area * h * h;
      near += area * a.skin[i][c], entered += area * a.entered[i][c], through += area * a.through[i][c];
    }
    EXPECT_NEAR(laid / t.in_cells[c], 1, 1e-5);
    EXPECT_NEAR(near / t.near[c], 1, 1e-5);
    EXPECT_NEAR(entered / t.entered[c], 1, 1e-4);
    EXPECT_NEAR(through / t.through[c], 1, 1e-5);
    EXPECT_EQ(t.entered[c], b.totals.entered[c]);
    EXPECT_EQ(t.through[c], b.totals.through[c]);
  }
  EXPECT_EQ(a.power, b.power);
}

// A lamp near a torus (beams leave it, enter no more, and mirror inside), three media in one: cell by cell and facet by
// facet as the march in double precision, where rounding does not choose another cell.
TEST_F(LightingBeams, MarchEqualsTwin) {
  const Mesh mesh = torus(1, 0.4f, 48, 24);
  const double eta = 1.4;
  Scene scene;
  scene.objects = {make_object(Role::translucent, mesh),
                   make_light(transformed(quad(0.1f, 0.1f), translation({0.3, 2, 0.2}) * rotation({1, 0, 0}, 180)),
                              {300, 200, 100})};
  scene.objects[0].eta = eta;
  const MediumField layered = [](glm::dvec3 p) {
    const glm::dvec3 dense = glm::dvec3(2, 6, 15) * (p.x > 0 ? 3.0 : 1.0);
    return MediumPoint{0.9 * dense, 0.1 * dense};
  };
  Body body(context, mesh, 20, layered, 3, eta);
  const Marched found = march(scene, body, 3, eta);
  const LitScene lit(context, scene, {1, 16, 512});
  ASSERT_EQ(lit.lighting.samples().area.size(), 1u);
  const glm::dvec3 lamp = lit.lighting.samples().area[0].position;

  BeamTwin twin(context, body, eta);
  const FacetReceivers receivers(context, body.domain());
  gpu::Commands commands(context);
  receivers.record(commands);
  commands.submit();
  const auto places = gpu::download<Receiver>(context, receivers.buffer());
  int lit_sides = 0, apart = 0;
  for (std::uint32_t i = 2; i < places.size(); ++i) {
    const glm::dvec3 flux = found.entered[i];  // shadows and all: lighting/gather.glsl has its own test
    if (flux == glm::dvec3(0)) continue;
    ++lit_sides;
    const glm::dvec3 normal = places[i].normal;
    const BeamTwin::Side side = twin.light(i, normal, glm::normalize(lamp - glm::dvec3(places[i].position)), flux);
    const double unit =
        3 * glm::length(found.unit) / (body.cut_cells()[i / 2].side[i % 2].area * std::pow(body.domain().frame.h, 2));
    const double within = 1e-4 * glm::length(flux) + unit;
    apart += glm::distance(side.gamma_s, glm::dvec3(found.gamma_s[i])) > within ||
             glm::distance(side.query_gamma, glm::dvec3(found.query_gamma[i])) > 4 * within ||
             glm::distance(side.skin, glm::dvec3(found.skin[i])) > within ||
             std::abs(side.skin_cosine - found.skin[i].w) > 1e-4;
  }
  EXPECT_GT(lit_sides, 300);
  EXPECT_LE(apart, lit_sides / 200);
  EXPECT_GT(twin.through.r, 0.05 * twin.entered.r);
  const std::size_t cells = twin.power.size();
  for (int c = 0; c < 3; ++c) {
    EXPECT_GT(twin.near[c], 0.1 * twin.entered[c]);
    EXPECT_GT(twin.in_cells[c], 0.05 * twin.entered[c]);
    EXPECT_NEAR(twin.near[c] + twin.in_cells[c] + twin.absorbed[c] + twin.through[c], twin.entered[c],
                1e-9 * twin.entered[c]);
    EXPECT_NEAR(found.totals.near[c], twin.near[c], 1e-4 * twin.entered[c]);
    EXPECT_NEAR(found.totals.in_cells[c], twin.in_cells[c], 1e-4 * twin.entered[c]);
    EXPECT_NEAR(found.totals.absorbed[c], twin.absorbed[c], 1e-4 * twin.entered[c]);
    EXPECT_NEAR(found.totals.through[c], twin.through[c], 1e-4 * twin.entered[c]);
    // A ray in the plane between two cells may go by either.
    double off = 0;
    int others = 0;
    for (std::size_t i = 0; i < cells; ++i) {
      const double difference = std::abs(found.power[c * cells + i] - twin.power[i][c]) +
                                std::abs(found.seen[c * cells + i] - twin.seen[i][c]);
      if (difference > 2e-5 * twin.entered[c])
        ++others;
      else
        off += difference;
    }
    std::printf("channel %d: %d cells otherwise, the rest off by %.1e of all\n", c, others, off / twin.entered[c]);
    EXPECT_LE(others, 4);
    EXPECT_LT(off, 1e-4 * twin.entered[c]);
  }

  // What leaves, spread over the facets around that look the same way (lighting/beam_through.comp).
  const std::vector<std::uint32_t> index = gpu::download<std::uint32_t>(context, body.domain().cut_index);
  const glm::ivec3 n = body.domain().frame.cells;
  std::vector<glm::dvec3> spread(places.size(), glm::dvec3(0));
  for (std::uint32_t i = 2; i < places.size(); ++i) {
    if (twin.leaving[i] == glm::dvec3(0)) continue;
    std::vector<std::pair<std::uint32_t, double>> around;
    double area = 0;
    for (int k = 0; k < 27; ++k) {
      const glm::ivec3 c = body.cut_cells()[i / 2].cell + glm::ivec3(k % 3, k / 3 % 3, k / 9) - 1;
      if (!glm::all(glm::lessThan(glm::uvec3(c), glm::uvec3(n)))) continue;
      const std::uint32_t other = index[c.x + std::size_t(n.x) * (c.y + std::size_t(n.y) * c.z)];
      for (std::uint32_t j = 2 * other; other != 0 && j < 2 * other + 2; ++j) {
        const GpuFacet& side = body.cut_cells()[j / 2].side[j % 2];
        if (side.area <= 0) continue;
        const double w =
            j == i ? 1 : std::max(0.0, glm::dot(glm::dvec3(places[i].normal), glm::dvec3(places[j].normal)));
        around.push_back({j, w});
        area += w * side.area * std::pow(body.domain().frame.h, 2);
      }
    }
    for (const auto& [j, w] : around) spread[j] += w * twin.leaving[i] / area;
  }
  double off = 0, all = 0;
  for (std::uint32_t i = 2; i < places.size(); ++i) {
    const double area = body.cut_cells()[i / 2].side[i % 2].area;
    off += area * glm::length(spread[i] - glm::dvec3(found.through[i]));
    all += area * glm::length(spread[i]);
  }
  std::printf("through: off by %.1e of all\n", off / all);
  EXPECT_LT(off, 5e-3 * all);
}

// Samples of a lamp that lie together go as one beam: it is laid down as those of as many lamps are, each a sample's
// light from its place.
TEST_F(LightingBeams, OneBeamForSamplesThatLieTogether) {
  const Mesh mesh = torus(1, 0.4f, 48, 24);
  Scene together, apart;
  together.objects = {
      make_object(Role::translucent, mesh),
      make_light(transformed(quad(1, 1), translation({0.3, 3, 0.2}) * rotation({1, 0, 0}, 180)), {300, 200, 100})};
  together.objects[0].eta = 1.4;
  apart.objects = {together.objects[0]};
  const LightSamples lights = sample_lights(together, 16);
  for (const LightSample& sample : lights.area)
    apart.objects.push_back(
        make_light(transformed(quad(1e-3f, 1e-3f), translation(sample.position) * rotation({1, 0, 0}, 180)),
                   sample.intensity / 1e-6f));
  Body body(
      context, mesh, 20,
      [](glm::dvec3 p) {
        const glm::dvec3 dense = glm::dvec3(2, 6, 15) * (p.x > 0 ? 3.0 : 1.0);
        return MediumPoint{0.9 * dense, 0.1 * dense};
      },
      3, 1.4);
  const GridFrame& frame = body.domain().frame;
  EXPECT_LE(beam_groups(lights, frame).size(), 8u);
  EXPECT_EQ(beam_groups(sample_lights(apart, 16), frame).size(), 16u);
  const Marched few = march(together, body, 3, 1.4, 16), many = march(apart, body, 3, 1.4, 16);
  const auto difference = [](const auto& a, const auto& b) {
    double apart_by = 0, all = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      apart_by += std::pow(glm::length(a[i] - b[i]), 2);
      all += std::pow(glm::length(b[i]), 2);
    }
    return std::sqrt(apart_by / all);
  };
  // Each cell with its neighbours, as what is scattered there counts: a beam meets single cells by chance.
  const auto in_eights = [&](const std::vector<float>& power) {
    const glm::ivec3 n = frame.cells;
    std::vector<float> sums(power.size());
    for (int i = 0; i < int(power.size()); ++i) {
      const glm::ivec3 cell(i % n.x, i / n.x % n.y, i / (n.x * n.y));
      sums[std::size_t((cell.z / 2 * n.y + cell.y / 2) * n.x + cell.x / 2)] += power[std::size_t(i)];
    }
    return sums;
  };
  const double in_cells = difference(in_eights(few.power), in_eights(many.power)),
               on_facets = difference(few.gamma_s, many.gamma_s);
  std::printf("apart by %.4f in the cells, %.4f on the facets\n", in_cells, on_facets);
  EXPECT_LT(in_cells, 0.05);
  EXPECT_LT(on_facets, 0.01);
  for (int c = 0; c < 3; ++c) {
    const double entered = many.totals.entered[c];
    EXPECT_NEAR(few.totals.entered[c], entered, 1e-4 * entered);
    EXPECT_NEAR(few.totals.near[c], many.totals.near[c], 1e-3 * entered);
    EXPECT_NEAR(few.totals.absorbed[c], many.totals.absorbed[c], 1e-3 * entered);
    EXPECT_NEAR(few.totals.through[c], many.totals.through[c], 1e-3 * entered);
  }
}

// Long ways of many samples: nothing is cut short (shared/beam.h, BEAM_MOST_TURNS).
TEST_F(LightingBeams, ManySamplesInAThinMedium) {
  const Mesh mesh = icosphere(3);
  const double eta = 1.5;
  Scene scene;
  scene.objects = {
      make_object(Role::translucent, mesh),
      make_light(transformed(quad(1, 1), translation({0.3, 3, 0.2}) * rotation({1, 0, 0}, 180)), {300, 200, 100})};
  scene.objects[0].eta = eta;
  scene.environment.radiance = {3, 2, 1};
  const MediumPoint point{glm::dvec3(0.02), glm::dvec3(0.005)};
  Body body(
      context, mesh, 20, [=](glm::dvec3) { return point; }, 3, eta);
  const LitScene lit(context, scene, {96, 32, 64});
  BeamSource beam(context, body.domain(), facet_starts(body.domain().frame, body.cut_cells()), 3);
  const FacetSource facets(context, body.domain());
  const Diffusion& d = body.diffusion();
  gpu::Commands commands(context);
  beam.record(commands, lit.lighting, {d.kappa(), d.absorption(), d.facet_medium(), d.kappa_scale(), 3}, eta);
  facets.record_direct(commands, lit.lighting, eta);
  commands.submit();
  const BeamTotals t = beam.totals();
  const auto entered = gpu::download<glm::vec3>(context, beam.entered()),
             gathered = gpu::download<glm::vec3>(context, facets.direct());
  glm::dvec3 all(0), apart(0);
  for (std::size_t i = 2; i < entered.size(); ++i) {
    const double area = body.cut_cells()[i / 2].side[i % 2].area * std::pow(body.domain().frame.h, 2);
    all += area * glm::dvec3(gathered[i]);
    apart += area * glm::abs(glm::dvec3(gathered[i]) - glm::dvec3(entered[i]));
  }
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(t.entered[c], all[c], 1e-4 * all[c]);
    EXPECT_LT(apart[c], 1e-4 * all[c]);
    EXPECT_NEAR(t.near[c] + t.in_cells[c] + t.absorbed[c] + t.through[c], t.entered[c], 1e-9 * all[c]);
    EXPECT_GT(t.through[c], 0.8 * all[c]);
  }
}

// Chords of a ball in parallel light, eta 1: what goes through is 2 (1 - (1 + x) e^-x) / x^2 with x = 2 R sigma_t.
TEST_F(LightingBeams, ThroughABall) {
  const Mesh mesh = icosphere(4);
  for (double sigma : {0.5, 2.0, 8.0}) {
    const MediumPoint point{glm::dvec3(0.8 * sigma), glm::dvec3(0.2 * sigma)};
    Body body(
        context, mesh, 32, [=](glm::dvec3) { return point; }, 1, 1.0);
    const Marched m = march(ball_scene(mesh, 1.0, glm::vec3(1e6f)), body, 1, 1.0);
    const double x = 2 * sigma, exact = 2 * (1 - (1 + x) * std::exp(-x)) / (x * x);
    const double found = m.totals.through.r / m.totals.entered.r;
    std::printf("sigma %.1f: through %.4f, exact %.4f, near %.3f\n", sigma, found, exact,
                m.totals.near.r / m.totals.entered.r);
    EXPECT_NEAR(found, exact, 1e-3);
    const double irradiance_mean = m.totals.entered.r / M_PI;  // W/m^2 on the disc of radius 1
    EXPECT_NEAR(irradiance_mean / (1e6 * 4 / 1e6), 1, 0.01);
  }
}

// Mean z of what a slab's cells receive and of the near light: 1 / sigma_t below the surface, on every grid.
TEST_F(LightingBeams, MeanDepthDoesNotDependOnTheGrid) {
  const Mesh mesh = transformed(box({2, 2, 1}, 8), rotation({1, 2, 3}, 0));
  const double sigma = 8;  // 8 mean free paths deep
  const MediumPoint point{glm::dvec3(sigma), glm::dvec3(0)};
  for (int cells : {10, 18, 32}) {
    Body body(
        context, mesh, cells, [=](glm::dvec3) { return point; }, 1, 1.0);
    const Marched m = march(ball_scene(mesh, 1.0, glm::vec3(1e6f)), body, 1, 1.0);
    const GridFrame& f = body.domain().frame;
    const std::vector<std::uint32_t> index = gpu::download<std::uint32_t>(context, body.domain().cut_index);
    // phi far below is s (z / kappa + 2 A): near light has it as its boundary value, the cells by their centroids'
    // depth.
    const double kappa = 1 / (3 * sigma), A = boundary_constant(internal_diffuse_reflectance(1.0));
    double drive = 0;
    for (std::size_t i = 0; i < index.size(); ++i) {
      const int z = int(i / (std::size_t(f.cells.x) * f.cells.y));
      const double depth = 0.5 - (f.origin.z + f.h * (float(z) + body.cut_cells()[index[i]].centre.z));
      drive += m.power[i] * (depth / kappa + 2 * A);
    }
    for (std::size_t i = 2; i < m.gamma_s.size(); ++i)
      drive += 4 * m.gamma_s[i].r * body.cut_cells()[i / 2].side[i % 2].area * f.h * f.h;
    const double exact = m.totals.entered.r * (1 / (sigma * kappa) + 2 * A);
    std::printf("%d cells, %.2f a mean free path: %.4f of exact\n", cells, 1 / (sigma * f.h), drive / exact);
    EXPECT_NEAR(drive / exact, 1, 0.015);
  }
}

TEST_F(LightingBeams, DirectionalSourceEqualsItsSum) {
  const Mesh mesh = icosphere(3);
  const double eta = 1.4;
  Scene scene = ball_scene(mesh, eta, {1e6f, 2e6f, 3e6f});
  const MediumPoint point{{9, 8, 6}, {0, 0.5, 3}};
  Body body(
      context, mesh, 16, [=](glm::dvec3) { return point; }, 3, eta);
  const LitScene lit(context, scene, {1, 0, 512});
  const DirectionalSource source(context, body.domain());
  gpu::Commands commands(context);
  source.record(commands, lit.lighting, body.diffusion().facet_medium(), eta);
  commands.submit();
  const auto gamma = gpu::download<glm::vec3>(context, source.gamma_s());
  const auto query = gpu::download<glm::vec3>(context, source.query_gamma());
  const double f_dr = internal_diffuse_reflectance(eta), A = boundary_constant(f_dr);
  const LightSample& lamp = lit.lighting.samples().area.at(0);
  const GridFrame& frame = body.domain().frame;
  int lit_sides = 0;
  for (std::size_t i = 2; i < gamma.size(); ++i) {
    const GpuFacet& side = body.cut_cells()[i / 2].side[i % 2];
    if (side.area < 0.01) continue;
    const glm::vec3 middle = frame.origin + frame.h * (glm::vec3(body.cut_cells()[i / 2].cell) + side.centre);
    const glm::dvec3 way(lamp.position - middle), towards = glm::normalize(way);
    const double cosine = glm::dot(glm::normalize(glm::dvec3(side.area_vector)), towards);
    if (cosine < 0.3) continue;
    ++lit_sides;
    const double mu = refracted_cosine(cosine, eta), sent = -glm::dot(glm::dvec3(lamp.normal), towards);
    const double entered = lamp.intensity.r * point_transfer(cosine, sent, glm::dot(way, way), eta);
    for (int c = 0; c < 3; ++c) {
      const double absorbed = point.sigma_a[c] / (point.sigma_a[c] + point.sigma_s_reduced[c]), E = entered * (c + 1);
      const double f = directional_boundary(mu, absorbed, A, 1 - f_dr),
                   leaving = directional_exit(mu, absorbed, A, 1 - f_dr);
      EXPECT_NEAR(gamma[i][c], f * E, 1e-3 * E);
      EXPECT_NEAR(query[i][c], (f - A * leaving) * E, 4e-3 * E);
    }
  }
  EXPECT_GT(lit_sides, 50);
}

}  // namespace
}  // namespace alabaster

// The passes between the linear solver and the surface, each alone against its double-precision twin on random inputs:
// scale, rescale, gradient, facets with source, surface, absorbed with energy. A thick and a thin plate, tilted:
// slivers, cells without neighbours along an axis, bent facets and sheets back to back in a cell all occur.
#include <random>

#include "diffusion/near_surface.h"
#include "support/diffusion_device.h"

namespace alabaster {
namespace {

struct Largest {  // difference and value seen
  double apart = 0, value = 0;
  void add(double got, double expected) {
    apart = std::max(apart, std::isfinite(got) ? std::abs(got - expected) : INFINITY);
    value = std::max(value, std::abs(expected));
  }
};

class GpuDiffusionSurface : public GpuTest {
 protected:
  explicit GpuDiffusionSurface(int channel_count = 3, int side_count = 2) : channels(channel_count), sides(side_count) {
    std::uniform_real_distribution<float> uniform(0, 1);
    for (glm::vec3& g : gamma) g = {uniform(engine), uniform(engine), uniform(engine) < 0.5f ? 0 : uniform(engine)};
    phi.assign(volume.size() * channels, 0.f);
    for (std::size_t i = 0; i < phi.size(); ++i)
      if (volume[i % volume.size()] > 0) phi[i] = 0.1f + uniform(engine);
    for (int c = 0; c < channels; ++c) scales.push_back({std::ldexp(1.f, 3 * c - 2), 1});
    gpu::upload(context, body.diffusion().pcg().solution(), phi);
    scale_buffer = gpu::make_buffer(context, scales, "scales");
    gamma_buffer = gpu::make_buffer(context, gamma, "gamma_s");
    std::vector<glm::vec3> query = gamma;
    for (std::size_t k = 0; k < query.size(); ++k) query[k] *= 0.5f + 0.25f * float(k % 3);
    query_buffer = gpu::make_buffer(context, query, "query");
  }

  SurfacePush push() const {
    return {n,
            static_cast<int>(cut.size()),
            channels,
            static_cast<float>(A),
            static_cast<float>(body.f_dt()),
            static_cast<float>(h),
            sides};
  }
  bool inside(glm::ivec3 c) const { return glm::all(glm::lessThan(glm::uvec3(c), glm::uvec3(n))); }
  std::size_t at(glm::ivec3 c) const { return c.x + std::size_t(n.x) * (c.y + std::size_t(n.y) * c.z); }
  double size(glm::ivec3 c) const { return inside(c) ? volume[at(c)] : 0; }
  std::uint32_t index(glm::ivec3 c) const { return inside(c) ? indices[at(c)] : 0; }
  glm::dvec3 centre(glm::ivec3 c) const { return glm::dvec3(cut[index(c)].centre); }
  double fluence(glm::ivec3 c, int channel) const {
    return inside(c) ? double(phi[channel * volume.size() + at(c)]) * scales[channel].unit : 0;
  }
  double gamma_of(std::size_t i, int side, int channel) const { return gamma[sides == 2 ? 2 * i + side : i][channel]; }
  double depth(std::size_t i, int side, int channel) const {
    return std::max(double(cut[i].side[side].distance), 0.05) * h / facets[i].kappa[channel];
  }
  /// 4 Gamma_s / F_dt, mean over the sides by area, or by the conductance between surface and unknown.
  double q(std::size_t i, int channel, bool by_conductance = false) const {
    double sum = 0, weights = 0;
    for (int side = 0; side < 2; ++side) {
      const double area = cut[i].side[side].area;
      const double weight = by_conductance ? area / (2 * A + depth(i, side, channel)) : area;
      sum += weight * dsbc_source(gamma_of(i, side, channel), body.f_dt());
      weights += weight;
    }
    return weights > 0 ? sum / weights : 0;
  }
  /// The query's Gamma over that of the boundary condition.
  double query_share(std::size_t i, int side) const { return 0.5 + 0.25 * double((sides == 2 ? 2 * i + side : i) % 3); }
  std::vector<glm::vec4> random_gradients() {
    std::uniform_real_distribution<float> uniform(-1, 1);
    std::vector<glm::vec4> g(cut.size() * channels);
    for (glm::vec4& v : g) v = {uniform(engine), uniform(engine), uniform(engine), 2 * uniform(engine)};
    return g;
  }
  template <typename T>
  gpu::Buffer results(std::size_t count) {
    return gpu::make_buffer(context, std::vector<T>(count), "results");
  }
  template <typename F>
  void for_cells(F f) const {
    for (int z = 0; z < n.z; ++z)
      for (int y = 0; y < n.y; ++y)
        for (int x = 0; x < n.x; ++x) f(glm::ivec3(x, y, z));
  }

  void check_surface();

  static MediumPoint medium(glm::dvec3 p) {
    return {(p.x > 0.1 ? 20.0 : 300.0) * glm::dvec3(1, 2, 3), glm::dvec3(0.1, 0.5, 2)};
  }

  int channels, sides;  // Gamma_s entries a cut cell
  Mesh mesh =
      transformed(joined(box({1, 0.09f, 0.6f}, 4), transformed(box({0.9f, 0.012f, 0.5f}, 4), translation({0, 0.2, 0}))),
                  rotation({1, 2, 3}, 31));
  Body body{context, mesh, 28, medium, channels};
  FluencePasses passes{context};
  const Domain& domain = body.domain();
  glm::ivec3 n = domain.frame.cells;
  double h = domain.frame.h, A = body.diffusion().A();
  std::vector<float> volume = gpu::download<float>(context, domain.volume);
  std::vector<std::uint32_t> indices = gpu::download<std::uint32_t>(context, domain.cut_index);
  std::vector<GpuCutCell> cut = body.cut_cells();
  std::vector<FacetMedium> facets = gpu::download<FacetMedium>(context, body.diffusion().facet_medium());
  std::mt19937 engine{5};
  std::vector<glm::vec3> gamma = std::vector<glm::vec3>(cut.size() * sides);
  std::vector<float> phi;
  std::vector<FluenceScale> scales;
  gpu::Buffer scale_buffer, gamma_buffer, query_buffer;
};

void GpuDiffusionSurface::check_surface() {
  const std::vector<glm::vec4> gradient = random_gradients();
  const gpu::Buffer gradients = gpu::make_buffer(context, gradient, "gradients");
  std::vector<gpu::Image> images;
  for (const char* name : {"phi up", "phi down", "gamma up", "gamma down"})
    images.push_back(gpu::image3d(context, n, VK_FORMAT_R32G32B32A32_SFLOAT, name));
  gpu::Commands commands(context);
  const std::vector<std::uint32_t> near = cells_near_surface(context, domain);
  const gpu::Buffer near_cells = gpu::make_buffer(context, near, "near cells");
  const gpu::Bindings bindings{
      {"cut_index", domain.cut_index}, {"cut_cells", domain.cut_cells}, {"scales", scale_buffer},
      {"gradients", gradients},        {"volume", domain.volume},       {"phi", body.diffusion().pcg().solution()},
      {"gamma_s", gamma_buffer},       {"query_gamma", query_buffer},   {"facets", body.diffusion().facet_medium()},
      {"near_cells", near_cells},      {"phi_up", images[0]},           {"phi_down", images[1]},
      {"gamma_up", images[2]},         {"gamma_down", images[3]}};
  for (const gpu::Image& image : images) commands.clear(image);
  commands.dispatch(passes.surface[0], {n.x / 4, n.y, n.z}, bindings, push());
  commands.dispatch(passes.surface[1], {near.size() / 8 + 8, 8, 1}, bindings, push());
  commands.submit();
  std::size_t kinds[4] = {0}, sheets = 0;  // whole, cut, taken from neighbours, far outside; with a slope a side
  Largest fluence_seen, gamma_seen;
  for (int side = 0; side < 2; ++side) {
    const std::vector<float> got = gpu::download<float>(context, images[side]),
                             got_gamma = gpu::download<float>(context, images[2 + side]);
    for_cells([&](glm::ivec3 cell) {
      for (int rgb = 0; rgb < 3; ++rgb) {
        const int c = std::min(rgb, channels - 1);
        const auto carried = [&](std::uint32_t i, glm::dvec3 point) {
          const GpuFacet& facet = cut[i].side[side];
          const glm::dvec4 g(gradient[c * cut.size() + i]);
          const glm::dvec3 away = point - glm::dvec3(cut[i].centre);
          if (glm::length(cut[i].facet.area_vector) > 0.5f * cut[i].facet.area || facet.area <= 0)
            return g.w + glm::dot(glm::dvec3(g), away);
          ++sheets;
          const glm::dvec3 normal = glm::normalize(glm::dvec3(facet.area_vector));
          const double across = glm::dot(normal, away), d = depth(i, side, c);
          const double boundary = dsbc_source(gamma_of(i, side, c), body.f_dt());
          const double sheet = (2 * A * g.w + d * boundary) / (2 * A + d);
          return g.w + glm::dot(glm::dvec3(g), away - across * normal) +
                 across * (sheet - g.w) / std::max(double(facet.distance), 0.05);
        };
        // Light of cells: of this side, and of the other as far as it faces the same way.
        struct Sums {
          double light = 0, area = 0;
          glm::dvec3 normal{0};
        };
        using Sides = std::array<Sums, 2>;
        const auto add = [&](Sides& sums, std::uint32_t i) {
          for (int which = 0; which < 2; ++which) {
            sums[which].light += cut[i].side[which].area * gamma_of(i, which, c) * query_share(i, which);
            sums[which].area += cut[i].side[which].area;
            sums[which].normal += glm::dvec3(cut[i].side[which].area_vector);
          }
        };
        const auto mean = [&](const Sides& sums) {
          const Sums &mine = sums[side], &other = sums[1 - side];
          const double lengths = glm::length(mine.normal) * glm::length(other.normal);
          const double alike = lengths > 1e-30 ? std::max(0.0, glm::dot(mine.normal, other.normal) / lengths) : 0;
          const double share = mine.area > 0 ? alike : 1, area = mine.area + share * other.area;
          return area > 0 ? (mine.light + share * other.light) / area : 0;
        };
        const std::uint32_t own = index(cell);
        double weights = 0, sum = 0;
        Sides around, here;
        if (own != 0) add(here, own);
        for (int k = 0; k < 27; ++k) {
          const glm::ivec3 d(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
          const std::uint32_t i = index(cell + d);
          if (i == 0) continue;
          const glm::dvec3 point = glm::dvec3(0.5) - glm::dvec3(d), apart = point - glm::dvec3(cut[i].centre);
          weights += cut[i].volume / glm::dot(apart, apart);
          sum += cut[i].volume / glm::dot(apart, apart) * carried(i, point);
          add(around, i);
        }
        double value = 0;
        int kind = 3;
        if (own == 0 && size(cell) > 0) {
          value = fluence(cell, c), kind = 0;
        } else if (own != 0 && size(cell) >= 0.05f) {
          value = carried(own, glm::dvec3(0.5)), kind = 1;
        } else if (weights > 0) {
          value = sum / weights, kind = 2;
        }
        ++kinds[kind];
        fluence_seen.add(got[4 * at(cell) + rgb], value);
        gamma_seen.add(got_gamma[4 * at(cell) + rgb], here[side].area > 0 ? mean(here) : mean(around));
      }
      fluence_seen.add(got[4 * at(cell) + 3], 1);
    });
  }
  for (std::size_t kind : kinds) EXPECT_GT(kind, 100u);
  EXPECT_GT(sheets, 10u);
  EXPECT_LT(fluence_seen.apart, 1e-5 * fluence_seen.value);
  EXPECT_LT(gamma_seen.apart, 1e-5 * gamma_seen.value);
}

class GpuDiffusionSurfaceGrey : public GpuDiffusionSurface {
 protected:
  GpuDiffusionSurfaceGrey() : GpuDiffusionSurface(1, 1) {}
};

TEST_F(GpuDiffusionSurface, ScaleIsThePowerOfTwoAboveTheLargestSource) {
  for (glm::vec3& g : gamma) g.z = 0;
  const gpu::Buffer light = gpu::make_buffer(context, gamma, "gamma_s");
  gpu::Commands commands(context);
  commands.dispatch(passes.scale, {256 * channels, 1, 1}, {{"gamma_s", light}, {"scales", scale_buffer}}, push());
  commands.submit();
  const std::vector<FluenceScale> got = gpu::download<FluenceScale>(context, scale_buffer);
  for (int c = 0; c < 2; ++c) {
    double largest = 0;
    for (std::size_t i = sides; i < gamma.size(); ++i)
      largest = std::max(largest, dsbc_source(double(gamma[i][c]), body.f_dt()));
    EXPECT_GT(got[c].unit, largest);
    EXPECT_LE(got[c].unit, 2 * largest);
    EXPECT_EQ(std::exp2(std::round(std::log2(got[c].unit))), got[c].unit);
    EXPECT_EQ(got[c].ratio, scales[c].unit / got[c].unit);
  }
  EXPECT_EQ(got[2].unit, 0);
  EXPECT_EQ(got[2].ratio, 0);
}

TEST_F(GpuDiffusionSurface, RescaleCarriesTheSolutionIntoTheNewUnit) {
  Pcg& pcg = body.diffusion().pcg();
  std::vector<float> low = phi;
  for (float& v : low) v *= 1e-8f;
  gpu::upload(context, pcg.solution_rest(), low);
  for (int c = 0; c < channels; ++c) scales[c].ratio = c == 2 ? 0 : std::ldexp(1.f, 5 - 7 * c);
  const gpu::Buffer ratios = gpu::make_buffer(context, scales, "scales");
  const Multigrid& multigrid = body.diffusion().multigrid();
  gpu::Commands commands(context);
  commands.dispatch(
      passes.rescale, multigrid.threads(0),
      {{"tiles", multigrid.tiles().packed}, {"scales", ratios}, {"high", pcg.solution()}, {"low", pcg.solution_rest()}},
      push());
  commands.submit();
  const std::vector<float> high = gpu::download<float>(context, pcg.solution()),
                           rest = gpu::download<float>(context, pcg.solution_rest());
  for (std::size_t i = 0; i < phi.size(); ++i) {
    const float ratio = scales[i / volume.size()].ratio;
    ASSERT_EQ(high[i], ratio * phi[i]) << i;
    ASSERT_EQ(rest[i], ratio * low[i]) << i;
  }
}

TEST_F(GpuDiffusionSurface, GradientEqualsTwin) {
  const gpu::Buffer gradients = results<glm::vec4>(cut.size() * channels);
  gpu::Commands commands(context);
  commands.dispatch(passes.gradient, {cut.size(), channels, 1},
                    {{"cut_index", domain.cut_index},
                     {"cut_cells", domain.cut_cells},
                     {"gamma_s", gamma_buffer},
                     {"facets", body.diffusion().facet_medium()},
                     {"scales", scale_buffer},
                     {"volume", domain.volume},
                     {"phi", body.diffusion().pcg().solution()},
                     {"gradients", gradients}},
                    push());
  commands.submit();
  const std::vector<glm::vec4> got = gpu::download<glm::vec4>(context, gradients);
  std::size_t slivers = 0;
  for (int c = 0; c < channels; ++c) {
    Largest slope, value;
    for (std::size_t i = 1; i < cut.size(); ++i) {
      const glm::ivec3 cell = cut[i].cell;
      slivers += cut[i].volume < 0.05f;
      glm::dmat3 matrix(0);
      glm::dvec3 right(0);
      const auto equation = [&](glm::dvec3 d, double weight, double difference) {
        matrix += weight / glm::dot(d, d) * glm::outerProduct(d, d);
        right += weight / glm::dot(d, d) * difference * d;
      };
      for (int axis = 0; axis < 3; ++axis)
        for (int side : {-1, 1}) {
          glm::ivec3 other = cell;
          other[axis] += side;
          if (size(other) <= 0) continue;
          equation(glm::dvec3(other - cell) + centre(other) - centre(cell), std::min(1.0, size(other) / 0.05),
                   fluence(other, c) - fluence(cell, c));
        }
      const glm::dvec3 area(cut[i].facet.area_vector);
      if (glm::length(area) > 0.5 * cut[i].facet.area)
        equation(glm::dvec3(cut[i].facet.centre) - centre(cell) + 2 * A * facets[i].kappa[c] / h * glm::normalize(area),
                 1, q(i, c) - fluence(cell, c));
      const double trace = matrix[0][0] + matrix[1][1] + matrix[2][2];
      const glm::dvec3 g = trace > 0 ? glm::inverse(matrix + glm::dmat3(1e-4 * trace)) * right : glm::dvec3(0);
      const glm::vec4 mine = got[c * cut.size() + i];
      for (int axis = 0; axis < 3; ++axis) slope.add(mine[axis], g[axis]);
      value.add(mine.w, fluence(cell, c));
    }
    EXPECT_GT(slope.value, 0);
    EXPECT_LT(slope.apart, 1e-3 * slope.value) << c;  // 1e-4 of the trace conditions the worst of the matrices
    EXPECT_LT(value.apart, 1e-6 * value.value) << c;
  }
  EXPECT_GT(slivers, 10u);
}

TEST_F(GpuDiffusionSurface, FacetsAndSourceEqualTwin) {
  const std::vector<glm::vec4> gradient = random_gradients();
  const gpu::Buffer gradients = gpu::make_buffer(context, gradient, "gradients");
  const gpu::Buffer cell_sources = results<float>(cut.size() * channels),
                    face_fluxes = results<float>(cut.size() * channels * 6),
                    facet_offsets = results<float>(cut.size() * channels);
  const Multigrid& multigrid = body.diffusion().multigrid();
  const std::vector<float> stencil = gpu::download<float>(context, body.diffusion().multigrid().finest().stencil);
  const std::vector<float> B = gpu::download<float>(context, body.diffusion().facet_conductances());
  const gpu::Image power_image = packed_image(context, n, channels, 1, "power in the cells");
  std::vector<float> power(volume.size() * channels);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (std::size_t i = 0; i < power.size(); ++i) power[i] = volume[i % volume.size()] > 0 ? uniform(engine) : 0;
  gpu::upload(context, power_image, power);
  const glm::vec3 per_power(0.5f, 2.f, 30.f);
  for (const auto& [corrected, in_cells] : {std::pair(false, false), {true, false}, {false, true}}) {
    gpu::Image& rhs = body.diffusion().pcg().rhs();
    gpu::Commands commands(context);
    commands.dispatch(passes.facets[corrected], {cut.size(), channels, 1},
                      {{"cut_index", domain.cut_index},
                       {"cut_cells", domain.cut_cells},
                       {"conductances", body.diffusion().facet_conductances()},
                       {"gamma_s", gamma_buffer},
                       {"facets", body.diffusion().facet_medium()},
                       {"scales", scale_buffer},
                       {"gradients", gradients},
                       {"stencil", body.diffusion().multigrid().finest().stencil},
                       {"cell_sources", cell_sources},
                       {"face_fluxes", face_fluxes},
                       {"facet_offsets", facet_offsets}},
                      push());
    commands.dispatch(passes.source[corrected][in_cells], multigrid.threads(0),
                      {{"tiles", multigrid.tiles().packed},
                       {"cut_index", domain.cut_index},
                       {"cut_cells", domain.cut_cells},
                       {"cell_sources", cell_sources},
                       {"face_fluxes", face_fluxes},
                       {"scales", scale_buffer},
                       {"volume_power", power_image},
                       {"rhs", rhs}},
                      SourcePush{n, static_cast<int>(cut.size()), per_power});
    commands.submit();
    const std::vector<float> got = gpu::download<float>(context, rhs);
    const std::vector<float> below = gpu::download<float>(context, facet_offsets);
    for (int c = 0; c < channels; ++c) {
      std::vector<double> b(volume.size(), 0.0);
      const auto carried = [&](std::size_t i, glm::dvec3 away) {
        const glm::dvec4 g(gradient[c * cut.size() + i]);
        return std::clamp(glm::dot(glm::dvec3(g), away), -0.25 * std::abs(g.w), 0.25 * std::abs(g.w));
      };
      Largest offset, source;
      for (std::size_t i = 1; i < cut.size(); ++i) {
        const GpuFacet& facet = cut[i].facet;
        const double length = glm::length(glm::dvec3(facet.area_vector));
        double o = 0;
        if (corrected && length > 0.5 * facet.area) {
          const glm::dvec3 normal = glm::dvec3(facet.area_vector) / length,
                           away = glm::dvec3(facet.centre) - glm::dvec3(cut[i].centre);
          o = carried(i, away - normal * glm::dot(away, normal));
        }
        offset.add(below[c * cut.size() + i], o);
        b[at(cut[i].cell)] += B[c * cut.size() + i] * (q(i, c, true) - o) / scales[c].unit;
      }
      // Every face once, what the one side gains the other loses.
      if (corrected)
        for_cells([&](glm::ivec3 upper) {
          for (int axis = 0; axis < 3; ++axis) {
            glm::ivec3 lower = upper;
            --lower[axis];
            const double T = stencil[upper.x + n.x * (axis + std::size_t(4) * (upper.y + n.y * (upper.z + c * n.z)))];
            if (!inside(lower) || T == 0) continue;
            const glm::dvec3 face(cut[index(upper)].low_face_centre[axis]);
            const auto towards_face = [&](glm::ivec3 cell) {
              if (index(cell) == 0) return 0.0;
              glm::dvec3 away = face - centre(cell);
              away[axis] = 0;
              return carried(index(cell), away);
            };
            const double flux = T * (towards_face(lower) - towards_face(upper)) / scales[c].unit;
            b[at(upper)] += flux;
            b[at(lower)] -= flux;
          }
        });
      for (std::size_t i = 0; i < b.size(); ++i) {
        if (in_cells) b[i] += double(per_power[c]) * power[c * b.size() + i] / scales[c].unit;
        source.add(got[c * b.size() + i], b[i]);
      }
      EXPECT_EQ(offset.value > 0, corrected);
      EXPECT_LE(offset.apart, 1e-5 * offset.value) << c;
      EXPECT_GT(source.value, 0);
      EXPECT_LT(source.apart, 1e-5 * source.value) << c << " corrected " << corrected;
    }
  }
}

TEST_F(GpuDiffusionSurface, EnergyEqualsTwin) {
  const std::vector<float> absorption = [&] {
    std::vector<float> values(phi.size());
    std::uniform_real_distribution<float> uniform(0, 1);
    for (float& v : values) v = uniform(engine);
    return values;
  }();
  const gpu::Image absorption_image = packed_image(context, n, channels, 1, "absorption");
  gpu::upload(context, absorption_image, absorption);
  std::vector<float> offsets;
  for (const glm::vec4& g : random_gradients()) offsets.push_back(0.1f * g.x);
  const gpu::Buffer facet_offsets = gpu::make_buffer(context, offsets, "offsets"), sums = results<EnergySums>(channels);
  const Multigrid& multigrid = body.diffusion().multigrid();
  Pcg& pcg = body.diffusion().pcg();
  const struct {
    SurfacePush surface;
    int partials_per_channel;
  } energy_push{push(), pcg.partials_per_channel()};
  gpu::Commands commands(context);
  commands.dispatch(passes.absorbed, multigrid.threads(0),
                    {{"tiles", multigrid.tiles().packed},
                     {"partials", pcg.partials()},
                     {"volume", domain.volume},
                     {"absorption", absorption_image},
                     {"phi", pcg.solution()}},
                    LevelPush{n, n, 0});
  commands.dispatch(passes.energy, {256 * channels, 1, 1},
                    {{"cut_index", domain.cut_index},
                     {"cut_cells", domain.cut_cells},
                     {"gamma_s", gamma_buffer},
                     {"query_gamma", query_buffer},
                     {"facets", body.diffusion().facet_medium()},
                     {"scales", scale_buffer},
                     {"partials", pcg.partials()},
                     {"facet_offsets", facet_offsets},
                     {"phi", pcg.solution()},
                     {"sums", sums}},
                    energy_push);
  commands.submit();
  const std::vector<EnergySums> got = gpu::download<EnergySums>(context, sums);
  for (int c = 0; c < channels; ++c) {
    double in = 0, out = 0, absorbed = 0;
    for (std::size_t i = 0; i < volume.size(); ++i)
      absorbed += double(absorption[c * volume.size() + i]) * volume[i] * phi[c * volume.size() + i];
    for (std::size_t i = 1; i < cut.size(); ++i)
      for (int side = 0; side < 2; ++side) {
        const double area = cut[i].side[side].area * h * h, own = fluence(cut[i].cell, c) + offsets[c * cut.size() + i];
        const double light = gamma_of(i, side, c), boundary = dsbc_source(light, body.f_dt()), d = depth(i, side, c);
        // phi_b of phi_b + 2 A kappa (phi_b - phi) / d = q; the query's bracket is what leaves through F_dt / 4.
        const double surface = (2 * A * own + d * boundary) / (2 * A + d);
        const double query = light * query_share(i, side);
        // What the boundary condition lets in, and what the query lets out.
        const double leaves = body.f_dt() / 4 * query_bracket(surface, query, A, body.f_dt());
        in += area * ((boundary - surface) / (2 * A) + leaves);
        out += area * leaves;
      }
    EXPECT_NEAR(got[c].in_, in, 1e-5 * in);
    EXPECT_NEAR(got[c].out_, out, 1e-4 * in);
    EXPECT_NEAR(got[c].absorbed, absorbed, 1e-5 * absorbed);
  }
}

// With a query Gamma of its own; without and with light that goes straight through.
TEST_F(GpuDiffusionSurface, ExitEqualsTwin) {
  std::vector<float> offsets;
  for (const glm::vec4& g : random_gradients()) offsets.push_back(0.1f * g.x);
  const gpu::Buffer facet_offsets = gpu::make_buffer(context, offsets, "offsets");
  std::vector<glm::vec3> through(2 * cut.size());
  for (std::size_t i = 0; i < through.size(); ++i) through[i] = {0.1f * float(i % 5), 0.2f * float(i % 3), 0.3f};
  const gpu::Buffer through_buffer = gpu::make_buffer(context, through, "through");
  const std::size_t first = 5;
  const gpu::Buffer sent = results<glm::vec3>(first + 2 * cut.size());
  const struct {
    SurfacePush surface;
    float exit_scale;
    std::uint32_t first;
  } exit_push{push(), 0.6f, first};
  for (bool straight : {false, true}) {
    gpu::Commands commands(context);
    commands.dispatch(passes.exit[straight], {2 * cut.size(), 1, 1},
                      {{"cut_index", domain.cut_index},
                       {"cut_cells", domain.cut_cells},
                       {"gamma_s", gamma_buffer},
                       {"query_gamma", query_buffer},
                       {"through", through_buffer},
                       {"facets", body.diffusion().facet_medium()},
                       {"scales", scale_buffer},
                       {"facet_offsets", facet_offsets},
                       {"phi", body.diffusion().pcg().solution()},
                       {"transmitted", sent}},
                      exit_push);
    commands.submit();
    const std::vector<glm::vec3> got = gpu::download<glm::vec3>(context, sent);
    Largest radiance;
    int clamped = 0;
    for (std::size_t i = 1; i < cut.size(); ++i)
      for (int side = 0; side < 2; ++side)
        for (int c = 0; c < channels && cut[i].side[side].area > 0; ++c) {
          const double own = fluence(cut[i].cell, c) + offsets[c * cut.size() + i], light = gamma_of(i, side, c);
          const double surface = dsbc_surface_fluence(own, dsbc_source(light, body.f_dt()), A, depth(i, side, c));
          const double bracket = query_bracket(surface, light * query_share(i, side), A, body.f_dt());
          clamped += bracket < 0;
          const double flux = body.f_dt() / 4 * std::max(bracket, 0.0) + (straight ? through[2 * i + side][c] : 0);
          radiance.add(got[first + 2 * i + side][c], flux * 0.6 / (M_PI * body.f_dt()));
        }
    EXPECT_GT(clamped, 0);
    EXPECT_LT(radiance.apart, 1e-5 * radiance.value);
  }
}

TEST_F(GpuDiffusionSurface, SurfaceEqualsTwin) { check_surface(); }
TEST_F(GpuDiffusionSurfaceGrey, SurfaceEqualsTwin) { check_surface(); }

}  // namespace
}  // namespace alabaster

// shading/beam_fluence.comp and spread_facets.comp on random inputs against their double-precision twins, on a plate
// that is tilted and thinner than a cell in part: both sides of the surface meet in a cell.
#include <random>

#include "shading/straight.h"
#include "support/diffusion_device.h"

namespace alabaster {
namespace {

class ShadingSpread : public GpuTest {
 protected:
  static Mesh wedge() {
    Mesh mesh = box({2, 0.3f, 1});
    for (glm::vec3& p : mesh.positions) p.y *= 0.1f + 0.45f * (p.x + 1);
    return transformed(mesh, rotation({1, 2, 3}, 25));
  }
  /// Three media, and a jump between two of them.
  static MediumPoint layered(glm::dvec3 p) {
    const glm::dvec3 dense = glm::dvec3(2, 6, 15) * (p.x > 0 ? 3.0 : 1.0);
    return {0.9 * dense, 0.1 * dense};
  }
  Body body{context, wedge(), 20, layered, 3, 1.3};
  const std::vector<float> kappa = gpu::download<float>(context, body.diffusion().kappa()),
                           absorption = gpu::download<float>(context, body.diffusion().absorption());
  const glm::dvec3 kappa_scale = body.diffusion().kappa_scale();
  const Domain& domain = body.domain();
  const glm::ivec3 n = domain.frame.cells;
  const std::vector<std::uint32_t> index = gpu::download<std::uint32_t>(context, domain.cut_index);
  const std::vector<float> volume = gpu::download<float>(context, domain.volume);
  std::mt19937 engine{11};
  std::uniform_real_distribution<float> uniform{0, 1};

  bool inside(glm::ivec3 c) const { return glm::all(glm::lessThan(glm::uvec3(c), glm::uvec3(n))); }
  std::size_t at(glm::ivec3 c) const { return c.x + std::size_t(n.x) * (c.y + std::size_t(n.y) * c.z); }
  static glm::ivec3 offset(int k) { return glm::ivec3(k % 3, k / 3 % 3, k / 9) - 1; }
  /// sigma_s', 1/h.
  glm::dvec3 scattering(glm::ivec3 c) const {
    glm::dvec3 result(0);
    for (int k = 0; k < 3 && volume[at(c)] > 0; ++k) {
      const double scale = kappa_scale[k], h = domain.frame.h;
      const double kap = kappa[k * volume.size() + at(c)] * scale,
                   sigma_a = absorption[k * volume.size() + at(c)] * scale / (h * h);
      result[k] = h * (1 / (3 * kap) - sigma_a);
    }
    return result;
  }
  gpu::Image cell_image(const char* name) { return gpu::image3d(context, n, VK_FORMAT_R32G32B32A32_SFLOAT, name); }
  template <class Check>
  void each_cell(Check check) const {
    for (int z = 0; z < n.z; ++z)
      for (int y = 0; y < n.y; ++y)
        for (int x = 0; x < n.x; ++x) check(glm::ivec3(x, y, z));
  }
};

TEST_F(ShadingSpread, BeamFluenceEqualsTwin) {
  for (int channels : {1, 3}) {
    GatherGrid grid = ray_grid(domain, body.diffusion(), 1.3);
    grid.channels = channels;
    const gpu::Buffer grid_buffer = gpu::make_buffer(context, std::vector<GatherGrid>{grid}, "grid");
    std::vector<float> power(volume.size() * channels);
    for (std::size_t i = 0; i < power.size(); ++i)
      if (volume[i % volume.size()] > 0) power[i] = uniform(engine);
    const gpu::Image power_image =
        gpu::image3d(context, {n.x / 4, n.y, n.z * channels}, VK_FORMAT_R32G32B32A32_SFLOAT, "power");
    gpu::upload(context, power_image, power);
    std::vector<glm::vec4> near(2 * body.cut_cells().size());
    for (glm::vec4& light : near) light = glm::vec4(uniform(engine), uniform(engine), uniform(engine), 1);
    const gpu::Buffer near_light = gpu::make_buffer(context, near, "near light");
    const gpu::Image fluence = cell_image("fluence"), shift = cell_image("shift"), spread = cell_image("spread");
    const gpu::Pass pass(context, "shading/beam_fluence.comp");
    gpu::Commands commands(context);
    commands.dispatch(pass, glm::uvec3(n),
                      {{"grid", grid_buffer},
                       {"volume", domain.volume},
                       {"power", power_image},
                       {"cut_cells", domain.cut_cells},
                       {"kappa", body.diffusion().kappa()},
                       {"absorption", body.diffusion().absorption()},
                       {"cut_index", domain.cut_index},
                       {"near_light", near_light},
                       {"fluence", fluence},
                       {"shift", shift},
                       {"spread", spread}});
    commands.submit();
    const auto got = gpu::download<glm::vec4>(context, fluence), with_skin = gpu::download<glm::vec4>(context, shift);
    EXPECT_EQ(gpu::download<glm::vec4>(context, spread), with_skin);
    double worst = 0, largest = 0;
    int widened = 0;
    each_cell([&](glm::ivec3 cell) {
      glm::dvec3 watts(0), watts_around(0), skin(0), skin_around(0), scatters(0), scatters_around(0);
      double size = 0, size_around = 0;
      for (int k = 0; k < 27; ++k) {
        const glm::ivec3 d = offset(k), c = cell + d;
        if (!inside(c)) continue;
        const int away = std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
        const double weight = away == 0 ? 1 : away == 1 ? 0.1 : 0.01;
        size += weight * volume[at(c)];
        size_around += (1 - weight) * volume[at(c)];
        for (int channel = 0; channel < 3; ++channel) {
          const double there = power[std::min(channel, channels - 1) * volume.size() + at(c)];
          watts[channel] += weight * there;
          watts_around[channel] += (1 - weight) * there;
          const double volume_scatters = volume[at(c)] * scattering(c)[std::min(channel, channels - 1)];
          for (std::size_t s = 0; index[at(c)] != 0 && s < 2; ++s) {
            const double area = body.cut_cells()[index[at(c)]].side[s].area * grid.h * grid.h;
            const double kept = area * near[2 * index[at(c)] + s][std::min(channel, channels - 1)];
            skin[channel] += weight * kept;
            skin_around[channel] += (1 - weight) * kept;
          }
          scatters[channel] += weight * volume_scatters;
          scatters_around[channel] += (1 - weight) * volume_scatters;
        }
      }
      const double wider = size_around > 0 ? std::clamp((1 - size) / size_around, 0.0, 1.0) : 0;
      watts += wider * watts_around;
      skin += wider * skin_around;
      scatters += wider * scatters_around;
      widened += wider > 0;
      for (int channel = 0; channel < 3; ++channel) {
        const double exact = watts[channel] > 0 ? watts[channel] / (scatters[channel] * grid.h * grid.h) : 0;
        // Beside a sliver of volume 1e-6 h^3 the fluence is a quotient of small numbers.
        worst = std::max(worst, std::abs(got[at(cell)][channel] - exact) / std::max(exact, 1.0));
        const double all = watts[channel] > 0 ? exact + skin[channel] / (scatters[channel] * grid.h * grid.h) : 0;
        worst = std::max(worst, std::abs(with_skin[at(cell)][channel] - all) / std::max(all, 1.0));
        largest = std::max(largest, exact);
      }
    });
    EXPECT_GT(widened, 100);
    EXPECT_GT(largest, 10);
    EXPECT_LT(worst, 1e-5);
  }
}

TEST_F(ShadingSpread, FacetsEqualTwin) {
  const auto& cuts = body.cut_cells();
  std::vector<glm::vec4> values(2 * cuts.size());
  for (glm::vec4& v : values) v = {uniform(engine), uniform(engine), uniform(engine), uniform(engine)};
  const gpu::Buffer buffer = gpu::make_buffer(context, values, "values");
  const gpu::Image up = cell_image("up"), down = cell_image("down");
  const gpu::Pass pass(context, "shading/spread_facets.comp");
  gpu::Commands commands(context);
  commands.dispatch(pass, glm::uvec3(n),
                    {{"values", buffer},
                     {"cut_index", domain.cut_index},
                     {"cut_cells", domain.cut_cells},
                     {"up", up},
                     {"down", down}},
                    GatherPicturePush{n, static_cast<int>(cuts.size())});
  commands.submit();
  const std::vector<glm::vec4> got[2] = {gpu::download<glm::vec4>(context, up),
                                         gpu::download<glm::vec4>(context, down)};
  double worst = 0;
  int both_sides = 0, from_around = 0;
  each_cell([&](glm::ivec3 cell) {
    glm::dvec4 sums[2] = {};
    double areas[2] = {};
    glm::dvec3 normals[2] = {};
    const auto add = [&](std::uint32_t i) {
      for (int s = 0; s < 2 && i != 0; ++s) {
        const GpuFacet& side = cuts[i].side[s];
        sums[s] += double(side.area) * glm::dvec4(values[2 * i + s]);
        areas[s] += side.area;
        normals[s] += glm::dvec3(side.area_vector);
      }
    };
    add(index[at(cell)]);
    both_sides += areas[0] > 0 && areas[1] > 0;
    if (areas[0] + areas[1] <= 0) {
      for (int k = 0; k < 27; ++k)
        if (inside(cell + offset(k))) add(index[at(cell + offset(k))]);
      from_around += areas[0] + areas[1] > 0;
    }
    const double lengths = std::max(glm::length(normals[0]) * glm::length(normals[1]), 1e-30);
    for (int s = 0; s < 2; ++s) {
      const double alike = areas[s] > 0 ? std::max(0.0, glm::dot(normals[0], normals[1]) / lengths) : 1;
      const double area = areas[s] + alike * areas[1 - s];
      const glm::dvec4 exact = area > 0 ? (sums[s] + alike * sums[1 - s]) / area : glm::dvec4(0);
      worst = std::max(worst, glm::distance(exact, glm::dvec4(got[s][at(cell)])));
    }
  });
  EXPECT_GT(both_sides, 10);
  EXPECT_GT(from_around, 100);
  EXPECT_LT(worst, 1e-5);
}

}  // namespace
}  // namespace alabaster

// What the passes between the linear solver and the surface need, with random inputs, for tests of each alone against
// its double-precision twin. A thick and a thin plate, tilted: slivers, cells without neighbours along an axis, bent
// facets and sheets back to back in a cell all occur.
#pragma once

#include <random>

#include "support/diffusion_device.h"

namespace alabaster {

struct Largest {  // difference and value seen
  double apart = 0, value = 0;
  void add(double got, double expected) {
    apart = std::max(apart, std::isfinite(got) ? std::abs(got - expected) : INFINITY);
    value = std::max(value, std::abs(expected));
  }
};

class SurfacePasses : public GpuTest {
 protected:
  explicit SurfacePasses(int channel_count = 3, int side_count = 2) : channels(channel_count), sides(side_count) {
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
  /// A table (shared/diffusion.h) of `layers` layers, and one that holds [layer][cut cell] and is taken back.
  gpu::Image table(int layers) { return cut_table(context, cut.size(), layers, "table"); }
  gpu::Image table(const std::vector<glm::vec4>& entries) {
    gpu::Image made = table(static_cast<int>(entries.size() / cut.size()));
    std::vector<glm::vec4> texels(made.bytes() / sizeof(glm::vec4));
    for (std::size_t i = 0; i < entries.size(); ++i)
      texels[i / cut.size() * layer_texels(made) + i % cut.size()] = entries[i];
    gpu::upload(context, made, texels);
    return made;
  }
  std::vector<glm::vec4> entries(const gpu::Image& of) {
    const std::vector<glm::vec4> texels = gpu::download<glm::vec4>(context, of);
    std::vector<glm::vec4> result(of.spec().size.z * cut.size());
    for (std::size_t i = 0; i < result.size(); ++i)
      result[i] = texels[i / cut.size() * layer_texels(of) + i % cut.size()];
    return result;
  }
  static std::size_t layer_texels(const gpu::Image& of) { return std::size_t(of.spec().size.x) * of.spec().size.y; }
  gpu::Image points() {
    gpu::Image made = table(DIFFUSION_POINT_LAYERS);
    gpu::Commands commands(context);
    commands.dispatch(passes.points, {cut.size(), 1, 1},
                      {{"cut_index", domain.cut_index}, {"cut_cells", domain.cut_cells}, {"points", made}}, push());
    commands.submit();
    return made;
  }
  template <typename F>
  void for_cells(F f) const {
    for (int z = 0; z < n.z; ++z)
      for (int y = 0; y < n.y; ++y)
        for (int x = 0; x < n.x; ++x) f(glm::ivec3(x, y, z));
  }

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

}  // namespace alabaster

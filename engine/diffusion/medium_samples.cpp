#include "diffusion/medium_samples.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <mutex>

#include "shared/optics.h"

namespace alabaster {

MediumField field_of(const Medium& medium) {
  const double similarity = 1 - medium.g;
  if (!medium.heterogeneous()) {
    const MediumPoint constant{similarity * medium.homogeneous.sigma_s, medium.homogeneous.sigma_a};
    return [constant](glm::dvec3) { return constant; };
  }
  return [medium, similarity](glm::dvec3 world) {
    const Coefficients c = medium.at(world);
    return MediumPoint{similarity * c.sigma_s, c.sigma_a};
  };
}

namespace {

glm::vec3 reduced_at(const MediumPoint& m) {
  glm::dvec3 reduced;
  for (int c = 0; c < 3; ++c) reduced[c] = reduced_intensity(m.sigma_a[c], m.sigma_s_reduced[c]);
  return glm::vec3(reduced);
}

}  // namespace

MediumSamples sample_medium(gpu::Context& context, const Domain& domain, const MediumField& field, int channels) {
  const glm::ivec3 n = domain.frame.cells;
  const double h = domain.frame.h, clearest = 100 * h * std::max({n.x, n.y, n.z});
  const std::vector<float> volume = gpu::download<float>(context, domain.volume);
  const std::vector<std::uint32_t> cut_index = gpu::download<std::uint32_t>(context, domain.cut_index);
  const std::vector<GpuCutCell> cut_cells = gpu::download<GpuCutCell>(context, domain.cut_cells);
  const std::size_t cells = volume.size();
  MediumSamples samples;
  samples.channels = channels;
  samples.kappa.assign(cells * channels, 0.f);
  samples.absorption.assign(cells * channels, 0.f);
  samples.facets.resize(cut_cells.size());
  samples.kappa_scale = glm::dvec3(0);
  std::mutex guard;
  tbb::parallel_for(0, n.z, [&](int z) {
    glm::dvec3 largest(0);
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x) {
        const std::size_t i = x + std::size_t(n.x) * (y + std::size_t(n.y) * z);
        if (volume[i] <= 0) continue;
        const GpuCutCell& cut = cut_cells[cut_index[i]];
        const glm::dvec3 local = glm::dvec3(x, y, z) + glm::dvec3(cut.centre);
        const MediumPoint m = field(glm::dvec3(domain.frame.origin) + h * local);
        glm::dvec3 kappa;
        for (int c = 0; c < 3; ++c) kappa[c] = 1 / std::max(3 * (m.sigma_s_reduced[c] + m.sigma_a[c]), 1 / clearest);
        for (int c = 0; c < channels; ++c) {
          samples.kappa[c * cells + i] = static_cast<float>(kappa[c]);
          samples.absorption[c * cells + i] = static_cast<float>(m.sigma_a[c] * h * h);
        }
        largest = glm::max(largest, kappa);
        if (cut_index[i] != 0) samples.facets[cut_index[i]] = {glm::vec3(kappa), reduced_at(m), glm::vec3(m.sigma_a)};
      }
    const std::lock_guard lock(guard);
    samples.kappa_scale = glm::max(samples.kappa_scale, largest);
  });
  for (int c = 0; c < channels; ++c) {
    const float scale = static_cast<float>(1 / samples.kappa_scale[c]);
    tbb::parallel_for(std::size_t(0), cells, [&](std::size_t i) {
      samples.kappa[c * cells + i] *= scale;
      samples.absorption[c * cells + i] *= scale;
    });
  }
  return samples;
}

}  // namespace alabaster

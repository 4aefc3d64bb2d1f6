#include "diffusion/medium_layer.h"

#include <algorithm>
#include <bit>

#include "diffusion/medium_samples.h"

namespace alabaster {

constexpr int most_samples = most_samples_an_axis * most_samples_an_axis * most_samples_an_axis;
static_assert(most_samples <= 64);

Pattern::Pattern(int m) : m_(m) {
  for (int k = 0; k < m; ++k)
    for (int j = 0; j < m; ++j)
      for (int i = 0; i < m; ++i) points_.push_back({along(i, j, k), along(j, k, i), along(k, i, j)});
  for (int axis = 0; axis < 3; ++axis) {
    for (int s = 0; s < count(); ++s) sorted_[axis].push_back(s);
    std::sort(sorted_[axis].begin(), sorted_[axis].end(),
              [&](int a, int b) { return points_[a][axis] < points_[b][axis]; });
  }
}

/// Of a bounded function of the resistivity: what is ten times the mean may not hide all else.
Texture texture_of(const Pattern& pattern, const glm::vec3* resistivities, std::uint64_t solid) {
  const int count = std::popcount(solid);
  glm::dvec3 mean(0), bounded[most_samples], sum(0), squares(0);
  for (int s = 0; s < pattern.count(); ++s)
    if (solid >> s & 1) mean += glm::dvec3(resistivities[s]) / double(count);
  for (int s = 0; s < pattern.count(); ++s) {
    if (!(solid >> s & 1)) continue;
    bounded[s] = glm::dvec3(resistivities[s]) / (glm::dvec3(resistivities[s]) + mean);
    sum += bounded[s];
    squares += bounded[s] * bounded[s];
  }
  Texture texture;
  texture.variance = glm::max(squares - sum * sum / double(count), 0.0);
  for (int axis = 0; axis < 3; ++axis) {
    int last = -1;
    for (int s : pattern.sorted(axis)) {
      if (!(solid >> s & 1)) continue;
      if (last >= 0) texture.steps[axis] += 0.5 * (bounded[s] - bounded[last]) * (bounded[s] - bounded[last]);
      last = s;
    }
  }
  return texture;
}

}  // namespace alabaster

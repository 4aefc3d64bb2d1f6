#include "diffusion/cell_noise.h"

#include <algorithm>
#include <vector>

namespace alabaster {
namespace {

constexpr float apart = 8;  // a lone cell's kappa and its neighbours'
constexpr double lone_share = 0.05;

}  // namespace

double cell_noise(glm::ivec3 n, std::span<const float> kappa) {
  float least = INFINITY, most = 0;
  for (const float k : kappa)
    if (k > 0) least = std::min(least, k), most = std::max(most, k);
  if (most <= most_cell_noise * least) return 1;
  const std::ptrdiff_t steps[3] = {1, n.x, std::ptrdiff_t(n.x) * n.y};
  std::vector<float> contrasts;
  std::size_t within = 0;
  for (int z = 1; z < n.z - 1; ++z)
    for (int y = 1; y < n.y - 1; ++y)
      for (int x = 1; x < n.x - 1; ++x) {
        const std::ptrdiff_t i = x + y * steps[1] + z * steps[2];
        if (kappa[i] <= 0) continue;
        float low = INFINITY, high = 0;
        for (const std::ptrdiff_t step : steps) {
          low = std::min({low, kappa[i - step], kappa[i + step]});
          high = std::max({high, kappa[i - step], kappa[i + step]});
        }
        if (low <= 0) continue;
        ++within;
        if (kappa[i] >= apart * high) contrasts.push_back(kappa[i] / low);
        if (low >= apart * kappa[i]) contrasts.push_back(high / kappa[i]);
      }
  if (contrasts.empty() || double(contrasts.size()) <= lone_share * double(within)) return 1;
  const auto middle = contrasts.begin() + std::ptrdiff_t(contrasts.size() / 2);
  std::nth_element(contrasts.begin(), middle, contrasts.end());
  return *middle;
}

}  // namespace alabaster

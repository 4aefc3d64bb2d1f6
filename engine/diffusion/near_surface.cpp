#include "diffusion/near_surface.h"

#include <algorithm>

namespace alabaster {

std::vector<std::uint32_t> cells_near_surface(gpu::Context& context, const Domain& domain) {
  const glm::ivec3 n = domain.frame.cells;
  const std::vector<std::uint32_t> cut = gpu::download<std::uint32_t>(context, domain.cut_index);
  const std::vector<float> volume = gpu::download<float>(context, domain.volume);
  const auto at = [&](glm::ivec3 c) { return c.x + std::size_t(n.x) * (c.y + std::size_t(n.y) * c.z); };
  std::vector<bool> near(cut.size());
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x) {
        if (cut[at({x, y, z})] == 0) continue;
        const glm::ivec3 low = glm::max(glm::ivec3(x, y, z) - 1, glm::ivec3(0)),
                         high = glm::min(glm::ivec3(x, y, z) + 1, n - 1);
        for (int k = low.z; k <= high.z; ++k)
          for (int j = low.y; j <= high.y; ++j)
            for (int i = low.x; i <= high.x; ++i) near[at({i, j, k})] = true;
      }
  constexpr float sliver = 0.05f;  // as in surface.comp
  std::vector<std::uint32_t> list, rest;
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x) {
        const std::size_t i = at({x, y, z});
        if (!near[i]) continue;
        const bool own = cut[i] == 0 ? volume[i] > 0 : volume[i] >= sliver;
        (own ? rest : list).push_back(std::uint32_t(x) | std::uint32_t(y) << 10 | std::uint32_t(z) << 20);
      }
  list.insert(list.end(), rest.begin(), rest.end());
  if (list.empty()) list.push_back(0);
  return list;
}

}  // namespace alabaster

#include "diffusion/near_surface.h"

#include <algorithm>

namespace alabaster {
namespace {

constexpr float sliver = 0.05f;  // as in surface.comp

/// How far the two sides of a surface face the same way, 0 to 1.
struct Sides {
  glm::vec3 normal[2] = {glm::vec3(0), glm::vec3(0)};
  void add(const GpuCutCell& cut) {
    for (int side = 0; side < 2; ++side) normal[side] += cut.side[side].area_vector;
  }
  float alike() const {
    const float lengths = glm::length(normal[0]) * glm::length(normal[1]);
    return std::max(0.f, glm::dot(normal[0], normal[1]) / std::max(lengths, 1e-30f));
  }
};

}  // namespace

NearSurface find_near_surface(gpu::Context& context, const Domain& domain) {
  const glm::ivec3 n = domain.frame.cells;
  const std::vector<std::uint32_t> cut = gpu::download<std::uint32_t>(context, domain.cut_index);
  const std::vector<float> volume = gpu::download<float>(context, domain.volume);
  const std::vector<GpuCutCell> cut_cells = gpu::download<GpuCutCell>(context, domain.cut_cells);
  const auto at = [&](glm::ivec3 c) { return c.x + std::size_t(n.x) * (c.y + std::size_t(n.y) * c.z); };
  std::vector<bool> near(cut.size());
  for (std::size_t i = 1; i < cut_cells.size(); ++i) {
    const glm::ivec3 low = glm::max(cut_cells[i].cell - 1, glm::ivec3(0)),
                     high = glm::min(cut_cells[i].cell + 1, n - 1);
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) near[at({x, y, z})] = true;
  }
  NearSurface result;
  std::vector<NearCell> rest;
  for (std::size_t i = 0; i < cut.size(); ++i) {
    if (!near[i]) continue;
    const glm::ivec3 cell(i % n.x, i / n.x % n.y, i / (std::size_t(n.x) * n.y));
    NearCell entry{std::uint32_t(cell.x) | std::uint32_t(cell.y) << 10 | std::uint32_t(cell.z) << 20,
                   static_cast<std::uint32_t>(result.neighbours.size()), 0, 0, 0};
    Sides around, here;
    for (int k = 0; k < 27; ++k) {
      const glm::ivec3 other = cell + glm::ivec3(k % 3, k / 3 % 3, k / 9) - 1;
      if (glm::any(glm::greaterThanEqual(glm::uvec3(other), glm::uvec3(n))) || cut[at(other)] == 0) continue;
      around.add(cut_cells[cut[at(other)]]);
      result.neighbours.push_back(cut[at(other)] | std::uint32_t(k) << 27);
    }
    if (cut[i] != 0) here.add(cut_cells[cut[i]]);
    entry.end = static_cast<std::uint32_t>(result.neighbours.size());
    entry.alike = around.alike();
    entry.alike_here = here.alike();
    const bool own = cut[i] == 0 ? volume[i] > 0 : volume[i] >= sliver;
    (own ? rest : result.cells).push_back(entry);
  }
  result.cells.insert(result.cells.end(), rest.begin(), rest.end());
  if (result.cells.empty()) result.cells.push_back({});
  if (result.neighbours.empty()) result.neighbours.push_back(0);
  return result;
}

}  // namespace alabaster

#include "diffusion/rim.h"

#include <algorithm>
#include <array>

#include "shared/diffusion.h"

namespace alabaster {
namespace {

using Entry = std::array<glm::uvec4, 2>;

gpu::Image entry_table(gpu::Context& context, const std::vector<Entry>& entries, const std::string& name) {
  const std::size_t rows =
                        std::max<std::size_t>(1, (entries.size() + DIFFUSION_TABLE_WIDTH - 1) / DIFFUSION_TABLE_WIDTH),
                    layer = rows * DIFFUSION_TABLE_WIDTH;
  std::vector<glm::uvec4> texels(2 * layer, glm::uvec4(0));
  for (std::size_t i = 0; i < entries.size(); ++i)
    for (std::size_t k = 0; k < 2; ++k) texels[k * layer + i] = entries[i][k];
  gpu::Image table =
      gpu::image3d(context, {DIFFUSION_TABLE_WIDTH, static_cast<int>(rows), 2}, VK_FORMAT_R32G32B32A32_UINT, name);
  gpu::upload(context, table, texels);
  return table;
}

}  // namespace

Rim find_rim(gpu::Context& context, const Domain& domain) {
  const glm::ivec3 n = domain.frame.cells;
  std::vector<std::uint32_t> entry = gpu::download<std::uint32_t>(context, domain.cut_index);
  const std::vector<float> volume = gpu::download<float>(context, domain.volume);
  const std::uint32_t cut_count = domain.summary.cut_cells + 1;
  const auto cut_at = [&](glm::ivec3 c) {
    if (glm::any(glm::greaterThanEqual(glm::uvec3(c), glm::uvec3(n)))) return 0u;
    const std::uint32_t found = entry[c.x + std::size_t(n.x) * (c.y + std::size_t(n.y) * c.z)];
    return found < cut_count ? found : 0;
  };
  std::vector<Entry> cells, texels;
  for (std::size_t i = 0; i < entry.size(); ++i) {
    if (entry[i] != 0 || volume[i] <= 0) continue;
    const glm::ivec3 c(i % n.x, i / n.x % n.y, i / (std::size_t(n.x) * n.y));
    const Entry beside{glm::uvec4(cut_at(c - glm::ivec3(1, 0, 0)), cut_at(c + glm::ivec3(1, 0, 0)),
                                  cut_at(c - glm::ivec3(0, 1, 0)), cut_at(c + glm::ivec3(0, 1, 0))),
                       glm::uvec4(cut_at(c - glm::ivec3(0, 0, 1)), cut_at(c + glm::ivec3(0, 0, 1)), 0, 0)};
    if (beside == Entry{}) continue;
    entry[i] = cut_count + static_cast<std::uint32_t>(cells.size());
    cells.push_back(beside);
  }
  for (std::size_t i = 0; i < entry.size(); i += 4) {  // rows are whole texels (choose_frame)
    const glm::uvec4 held(entry[i], entry[i + 1], entry[i + 2], entry[i + 3]);
    if (held != glm::uvec4(0))
      texels.push_back({held, glm::uvec4(i % n.x / 4, i / n.x % n.y, i / (std::size_t(n.x) * n.y), 0)});
  }
  return {static_cast<int>(cells.size()), static_cast<int>(texels.size()),
          entry_table(context, cells, "cells of the rim"), entry_table(context, texels, "texels of the rim")};
}

}  // namespace alabaster

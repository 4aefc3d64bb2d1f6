#include "diffusion/bricks.h"

#include "shared/diffusion.h"

namespace alabaster {
namespace {

constexpr int width = 4 * DIFFUSION_BRICK_X, height = DIFFUSION_BRICK_Y, group = DIFFUSION_GROUP / 8;

/// Whether a brick holds cells, x fastest, then y, then z.
struct Held {
  glm::ivec3 counts;
  std::vector<std::uint8_t> bricks;
  bool at(int x, int y, int z) const { return bricks[x + std::size_t(counts.x) * (y + std::size_t(counts.y) * z)]; }
};

Held held_bricks(glm::ivec3 n, const std::vector<std::uint8_t>& active) {
  Held held{{(n.x + width - 1) / width, (n.y + height - 1) / height, n.z}, {}};
  held.bricks.resize(std::size_t(held.counts.x) * held.counts.y * n.z);
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x)
        held.bricks[x / width + std::size_t(held.counts.x) * (y / height + std::size_t(held.counts.y) * z)] |=
            active[x + std::size_t(n.x) * (y + std::size_t(n.y) * z)];
  return held;
}

BrickList on_device(gpu::Context& context, std::vector<std::uint32_t> list, std::uint32_t none,
                    const std::string& name) {
  while (list.empty() || list.size() % group != 0) list.push_back(none);
  return {gpu::make_buffer(context, list, name), static_cast<int>(list.size())};
}

}  // namespace

BrickList make_bricks(gpu::Context& context, glm::ivec3 n, const std::vector<std::uint8_t>& active) {
  const Held held = held_bricks(n, active);
  std::vector<std::uint32_t> list;
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < held.counts.y; ++y)
      for (int x = 0; x < held.counts.x; ++x)
        if (held.at(x, y, z)) list.push_back(std::uint32_t(x) | std::uint32_t(y) << 10 | std::uint32_t(z) << 20);
  return on_device(context, std::move(list), DIFFUSION_NO_BRICK, "diffusion bricks");
}

BrickList make_columns(gpu::Context& context, glm::ivec3 n, const std::vector<std::uint8_t>& active, int layers) {
  const Held held = held_bricks(n, active);
  std::vector<std::uint32_t> list;
  for (int slab = 0; slab < n.z; slab += layers)
    for (int y = 0; y < held.counts.y; ++y)
      for (int x = 0; x < held.counts.x; ++x)
        for (int z = slab, end = std::min(slab + layers, n.z); z < end; ++z) {
          const int lowest = z;
          while (z < end && held.at(x, y, z)) ++z;
          if (z > lowest)
            list.push_back(std::uint32_t(x) | std::uint32_t(y) << 7 | std::uint32_t(lowest) << 15 |
                           std::uint32_t(z - lowest) << 25);
        }
  return on_device(context, std::move(list), 0, "diffusion columns");
}

}  // namespace alabaster

// The part of a level that holds cells, as lists of bricks and of columns of them (shared/diffusion.h), filled up to
// whole workgroups.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "gpu/resources.h"

namespace alabaster {

struct BrickList {
  gpu::Buffer packed;
  int count = 0;
};

/// The bricks of a grid of n cells in which `active`, one value a cell, x fastest, is not zero.
BrickList make_bricks(gpu::Context& context, glm::ivec3 n, const std::vector<std::uint8_t>& active);

/// The same bricks as columns of at most `layers` (DIFFUSION_COLUMN_BRICKS at most). Columns end at multiples of it, so
/// that neighbours in the list are neighbours in the grid.
BrickList make_columns(gpu::Context& context, glm::ivec3 n, const std::vector<std::uint8_t>& active, int layers);

}  // namespace alabaster

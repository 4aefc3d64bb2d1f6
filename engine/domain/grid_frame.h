// Where a solver grid lies: cubic cells, cell (i, j, k) spans origin + h * [i, i+1] x [j, j+1] x [k, k+1].
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "scene/scene.h"

namespace alabaster {

struct GridFrame {
  glm::ivec3 cells{0};  // x is a multiple of 4: four x-neighbours share one rgba32f texel
  float h = 0;          // m
  glm::vec3 origin{0};  // m, world; low corner of cell (0, 0, 0)
};

constexpr int smallest_grid = 4, largest_grid = 1024;  // cells along the longest side

/// A frame of about `cells_along_longest` cells along the longest side of `bounds`, which it holds with a margin of at
/// least 1.25 cells everywhere. The quarter keeps the faces of an axis-aligned box off the grid planes. cells.x is
/// rounded up to a multiple of `alignment_x` (itself a multiple of 4). Throws UserError for fewer cells than
/// smallest_grid or more than largest_grid, and for bounds that are empty or not finite.
GridFrame choose_frame(const Bounds& bounds, int cells_along_longest, int alignment_x = 4);

/// The mesh's vertices in grid units ((p - origin) / h), each coordinate rounded to a multiple of lattice_step(), so
/// that subtracting the low corner of any cell is exact in single precision. Throws UserError for a vertex outside the
/// frame's inner cells (a margin of one cell must stay empty) or not finite.
std::vector<glm::vec3> grid_positions(const Mesh& mesh, const GridFrame& frame);

/// 2^-23 times the power of two that holds the largest number of cells: 7.6e-6 cells at 64^3, 1.5e-5 at 128^3.
float lattice_step(const GridFrame& frame);

}  // namespace alabaster

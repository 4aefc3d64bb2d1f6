// Media that are noise at the scale of the solver's cells.
#pragma once

#include <glm/glm.hpp>
#include <span>

namespace alabaster {

/// Beyond this contrast of noise at the scale of a cell a user is warned.
inline constexpr double most_cell_noise = 1e4;

/// Lone cells: whose kappa lies above that of all six neighbours, or below that of all six, eightfold or more. Sheets,
/// veins, needles and blocks of two cells or more have none but at their ends. Where more than a twentieth of the cells
/// within is alone, the median over them of the contrast to the neighbour furthest away; else 1. `kappa`: in any unit,
/// of n.x n.y n.z cells, x fastest, 0 outside.
double cell_noise(glm::ivec3 n, std::span<const float> kappa);

}  // namespace alabaster

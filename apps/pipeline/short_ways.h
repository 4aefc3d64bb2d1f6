// Media in which light goes less far than a cell.
#pragma once

#include <string>

#include "diffusion/medium_samples.h"
#include "domain/grid_frame.h"

namespace alabaster {

/// Where the diffusion length l = sqrt(kappa / sigma_a) is below a cell under more than a twentieth of an object's
/// surface, one line that says so and names the grid (of `grid` cells along the longest side now) that holds l there
/// but for a tenth of those places; else empty. What is left of the light under the surface then varies from cell to
/// cell with how the surface cuts them: mottling.
std::string short_ways_warning(const MediumSamples& medium, const GridFrame& frame, int grid);

}  // namespace alabaster

// The cells that the surface query may read beside the cut cells: those with a cut cell among the 27 around.
#pragma once

#include <cstdint>
#include <vector>

#include "domain/domain.h"

namespace alabaster {

/// Packed x | y << 10 | z << 20, those whose fluence surface.comp takes from the cells around (slivers, cells outside)
/// before the others: neighbours in the list do the same work. Never empty; ascending within each part.
std::vector<std::uint32_t> cells_near_surface(gpu::Context& context, const Domain& domain);

}  // namespace alabaster

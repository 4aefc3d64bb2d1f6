// The cells that the surface query may read beside the cut cells: those with a cut cell among the 27 around.
#pragma once

#include <vector>

#include "domain/domain.h"
#include "shared/diffusion.h"

namespace alabaster {

struct NearSurface {
  /// Those whose fluence surface.comp takes from the cells around (slivers, cells outside) before the others:
  /// neighbours in the list do the same work. Never empty; ascending within each part.
  std::vector<NearCell> cells;
  std::vector<std::uint32_t> neighbours;  // cut cell | n << 27, n = 0..26 its place around the cell, x fastest
};

NearSurface find_near_surface(gpu::Context& context, const Domain& domain);

}  // namespace alabaster

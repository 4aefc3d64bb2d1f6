// Where the surface makes the right-hand side: in the cut cells, and by the corrections of their faces in the whole
// cells beside them, which are the rim.
#pragma once

#include "domain/domain.h"

namespace alabaster {

struct Rim {
  int cells = 0, texels = 0;
  /// Tables (shared/diffusion.h) of uvec4. Of every whole cell of the rim the cut cells at its faces -x +x -y +y, then
  /// -z +z; 0 for none. Of every texel with a cut cell or a cell of the rim what stands in its four cells: 0, a cut
  /// cell, or the number of cut cells, entry 0 included, plus a cell of the rim; then its x, y, z.
  gpu::Image cell_table, texel_table;
};

Rim find_rim(gpu::Context& context, const Domain& domain);

}  // namespace alabaster

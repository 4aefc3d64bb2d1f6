// The cut cells that the domain hands on.
#include "shared/domain.h"
layout(binding = 1, r32ui) uniform readonly uimage3D cut_index;
layout(binding = 2, scalar) readonly buffer CutCells { GpuCutCell cut_cells[]; };

const float least_flatness = 0.5;  // a facet that is bent more has no normal

bool bent(GpuFacet facet) { return length(facet.area_vector) <= least_flatness * facet.area; }

uint cut_at(ivec3 cell) { return imageLoad(cut_index, cell).r; }

// The cut cells that the domain hands on.
#include "shared/domain.h"
#include "shared/optics.h"
#include "diffusion/table.glsl"
layout(binding = 1, r32ui) uniform readonly uimage3D cut_index;
layout(binding = 2, scalar) readonly buffer CutCells { GpuCutCell cut_cells[]; };

const float least_flatness = 0.5;  // a facet that is bent more has no normal

bool bent(GpuFacet facet) { return length(facet.area_vector) <= least_flatness * facet.area; }

const float least_distance = 0.05;  // of an unknown from a face or the surface, in h

// B of one side of a cell's surface: the sides of a thin part lie at their own depths. `resistance` is A and `k` kappa / h, or
// both in another unit.
float side_conductance(uint index, int side, float resistance, float k) {
  GpuFacet facet = cut_cells[index].side[side];
  return facet.area > 0 ? facet.area * dsbc_conductance(resistance, max(facet.distance, least_distance) / k) : 0;
}

uint cut_at(ivec3 cell) { return imageLoad(cut_index, cell).r; }

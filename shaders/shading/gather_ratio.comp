// The level of the gather on each facet: flux that the diffusion equation sends out over the flux that the gather does, both over
// the facets around that look the same way. One facet's own, by a few directions from one point, says little in a crease.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/domain.h"
#include "shared/gather.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { GatherPicturePush push; };
layout(binding = 0, scalar) readonly buffer Fluxes { GatherFlux fluxes[]; };  // two a cut cell
layout(binding = 1, r32ui) uniform readonly uimage3D cut_index;
layout(binding = 2, scalar) readonly buffer CutCells { GpuCutCell cut_cells[]; };
layout(binding = 3, scalar) writeonly buffer Levels { vec4 levels[]; };  // two a cut cell
layout(binding = 4, scalar) buffer Counts { uint counts[]; };            // GATHER_* of shared/gather.h

void main() {
  const uint entry = gl_GlobalInvocationID.x;
  if (entry >= 2 * push.count) return;
  const GpuFacet own = cut_cells[entry / 2].side[entry % 2];
  const bool there = entry > 1 && own.area > 0 && length(own.area_vector) > 0;
  vec3 wanted = vec3(0), gathered = vec3(0);
  for (int n = there ? 0 : 27; n < 27; ++n) {
    const uint index = imageLoad(cut_index, cut_cells[entry / 2].cell + ivec3(n % 3, n / 3 % 3, n / 9) - 1).r;
    for (uint other = 2 * index; index != 0 && other < 2 * index + 2; ++other) {
      const GpuFacet side = cut_cells[index].side[other % 2];
      const float size = length(side.area_vector);
      if (side.area <= 0 || size <= 0) continue;
      const float weight = side.area * max(0, dot(own.area_vector, side.area_vector)) / size;
      wanted += weight * fluxes[other].wanted;
      gathered += weight * fluxes[other].gathered;
    }
  }
  vec4 level = vec4(1);
  bool bounded = false;
  for (int c = 0; c < 3; ++c) {
    if (gathered[c] <= 0) continue;
    const float ratio = wanted[c] / gathered[c];
    level[c] = clamp(ratio, GATHER_LEAST_LEVEL, GATHER_MOST_LEVEL);
    bounded = bounded || level[c] != ratio;
  }
  levels[entry] = level;
  if (there) atomicAdd(counts[GATHER_SIDES], 1u);
  if (bounded) atomicAdd(counts[GATHER_BOUNDED], 1u);
}

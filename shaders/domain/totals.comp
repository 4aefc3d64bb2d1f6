// Volume, area and area vector of the cut cells, added up by workgroup in a fixed order. One thread a cut cell.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/domain.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { uint count; };
layout(binding = 0, scalar) readonly buffer CutCells { GpuCutCell cut_cells[]; };
struct Total {
  float volume, area;
  vec3 area_vector;
};
layout(binding = 1, scalar) writeonly buffer Totals { Total totals[]; };

shared Total part[64];

void main() {
  uint thread = gl_GlobalInvocationID.x, lane = gl_LocalInvocationID.x;
  part[lane] = Total(0.0, 0.0, vec3(0));
  if (thread < count) {
    part[lane].volume = cut_cells[thread + 1u].volume;
    part[lane].area = cut_cells[thread + 1u].facet.area;
    part[lane].area_vector = cut_cells[thread + 1u].facet.area_vector;
  }
  barrier();
  if (lane > 0u) return;
  Total sum = part[0];
  for (int i = 1; i < 64; ++i) {
    sum.volume += part[i].volume;
    sum.area += part[i].area;
    sum.area_vector += part[i].area_vector;
  }
  totals[gl_WorkGroupID.x] = sum;
}

// Two receivers a cut cell: the middles of its surface's two sides, in world space. A side without area gets normal 0.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/domain.h"
#include "shared/lighting.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { FacetPush push; };
layout(binding = 0, scalar) readonly buffer CutCells { GpuCutCell cut_cells[]; };
layout(binding = 1, scalar) writeonly buffer Receivers { Receiver receivers[]; };
void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= 2 * push.cut_cells) return;
  GpuFacet side = cut_cells[i / 2].side[i % 2];
  float vector_length = length(side.area_vector);
  bool there = side.area > 0.0 && vector_length > 0.0;
  vec3 normal = there ? side.area_vector / vector_length : vec3(0.0);
  // The middle of a bent piece of surface lies below it, the more the shorter its area vector is beside its area.
  float straight = there ? min(vector_length / side.area, 1.0) : 1.0;
  float slack = push.h * (0.02 + 0.5 * sqrt(1.0 - straight * straight));
  vec3 position = push.origin + push.h * (vec3(cut_cells[i / 2].cell) + side.centre);
  receivers[i] = Receiver(position, normal, slack);
}

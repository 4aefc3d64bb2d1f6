// What every island is to be lifted by: E^-1 of what its pieces sum to (islands.comp), always in the same order.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform PushBlock { LiftPush push; };
layout(binding = 0, scalar) readonly buffer Islands { IslandPieces islands[]; };
layout(binding = 1, scalar) readonly buffer Sums { float sums[]; };
layout(binding = 2, scalar) writeonly buffer Lifts { float lifts[]; };  // 0 for cells on none, then one an island

void main() {
  uint island = gl_GlobalInvocationID.x;
  if (island >= push.islands) return;
  float sum = 0;
  for (uint k = islands[island].begin; k < islands[island].end; ++k) sum += sums[k];
  lifts[1 + island] = islands[island].weight * sum;
}

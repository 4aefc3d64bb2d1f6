// Where an invocation works, on any level. The finest level runs over the list of tiles that hold
// cells, workgroup (tile, channel); the others over all texels.
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"

layout(local_size_x = DIFFUSION_TILE_X, local_size_y = DIFFUSION_TILE_Y) in;
layout(constant_id = 0) const int finest = 0;
#ifndef LEVEL_PUSH
#define LEVEL_PUSH LevelPush
#endif
layout(push_constant, scalar) uniform PushBlock { LEVEL_PUSH push; };
layout(binding = 0, scalar) readonly buffer Tiles { uint tiles[]; };

const ivec3 step_x = ivec3(1, 0, 0), step_y = ivec3(0, 1, 0), step_z = ivec3(0, 0, 1);

int texels(int cells) { return (cells + 3) >> 2; }

int channel_here() { return finest != 0 ? int(gl_WorkGroupID.y) : int(gl_WorkGroupID.z) / push.cells.z; }

ivec3 texel_here() {
  if (finest == 0) return ivec3(gl_GlobalInvocationID);
  uint tile = tiles[gl_WorkGroupID.x];
  ivec3 corner = ivec3(tile & 1023u, tile >> 10 & 1023u, tile >> 20) * ivec3(DIFFUSION_TILE_X, DIFFUSION_TILE_Y, 1);
  return corner + ivec3(gl_LocalInvocationID.xy, int(gl_WorkGroupID.y) * push.cells.z);
}

// The four cells one to the left or right of a texel's own.
vec4 shifted_left(vec4 before, vec4 own) { return vec4(before.w, own.xyz); }
vec4 shifted_right(vec4 own, vec4 after) { return vec4(own.yzw, after.x); }

ivec3 offset(int k) { return ivec3(k % 3, k / 3 % 3, k / 9) - 1; }

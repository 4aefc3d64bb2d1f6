// Where an invocation works, on any level: the list of its level's bricks that hold cells, eight invocations a brick of
// 2 x 4 texels; gl_WorkGroupID.y is the channel. What is outside of bricks is never written, and zero.
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"

layout(local_size_x = DIFFUSION_GROUP) in;
layout(constant_id = 0) const int finest = 0;
#ifndef LEVEL_PUSH
#define LEVEL_PUSH LevelPush
#endif
layout(push_constant, scalar) uniform PushBlock { LEVEL_PUSH push; };
layout(binding = 0, scalar) readonly buffer Bricks { uint bricks[]; };

const ivec3 step_x = ivec3(1, 0, 0), step_y = ivec3(0, 1, 0), step_z = ivec3(0, 0, 1);

int texels(int cells) { return (cells + 3) >> 2; }

int channel_here() { return int(gl_WorkGroupID.y); }

// On a level of `layers` cells along z.
ivec3 texel_of(int layers) {
  uint brick = bricks[gl_GlobalInvocationID.x >> 3], lane = gl_GlobalInvocationID.x & 7;
  ivec3 corner = ivec3((brick & 1023u) * DIFFUSION_BRICK_X, (brick >> 10 & 1023u) * DIFFUSION_BRICK_Y, brick >> 20);
  return corner + ivec3(lane % DIFFUSION_BRICK_X, lane / DIFFUSION_BRICK_X, channel_here() * layers);
}
ivec3 texel_here() { return texel_of(push.cells.z); }

// Where the pass goes by columns: the lowest texel, and of how many layers.
struct Column {
  ivec3 texel;
  int layers;
};

Column column_here() {
  uint column = bricks[gl_GlobalInvocationID.x >> 3], lane = gl_GlobalInvocationID.x & 7;
  ivec3 corner = ivec3((column & 127u) * DIFFUSION_BRICK_X, (column >> 7 & 255u) * DIFFUSION_BRICK_Y, column >> 15 & 1023u);
  ivec3 lanes = ivec3(lane % DIFFUSION_BRICK_X, lane / DIFFUSION_BRICK_X, channel_here() * push.cells.z);
  return Column(corner + lanes, int(column >> 25));
}

// The four cells one to the left or right of a texel's own.
vec4 shifted_left(vec4 before, vec4 own) { return vec4(before.w, own.xyz); }
vec4 shifted_right(vec4 own, vec4 after) { return vec4(own.yzw, after.x); }

ivec3 offset(int k) { return ivec3(k % 3, k / 3 % 3, k / 9) - 1; }

// x = A^-1 b on the coarsest level, by the inverse that the CPU made of it. Rows and columns run over whole texels.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform PushBlock { LevelPush push; };
layout(binding = 0, scalar) readonly buffer Inverse { vec4 inverse[]; };  // [channel][row cell][column texel]
layout(binding = 1, rgba32f) uniform readonly image3D b;
layout(binding = 2, rgba32f) uniform writeonly image3D x;

void main() {
  int nx4 = (push.cells.x + 3) >> 2, count = nx4 * push.cells.y * push.cells.z;
  int row = int(gl_GlobalInvocationID.x), channel = int(gl_WorkGroupID.y);
  if (row >= count) return;
  vec4 sum = vec4(0);
  for (int column = 0; column < count; ++column) {
    ivec3 c = ivec3(column % nx4, column / nx4 % push.cells.y, column / (nx4 * push.cells.y) + channel * push.cells.z);
    vec4 value = imageLoad(b, c);
    int at = (channel * count + row) * 4 * count + column;
    for (int lane = 0; lane < 4; ++lane) sum[lane] += dot(inverse[at + lane * count], value);
  }
  ivec3 t = ivec3(row % nx4, row / nx4 % push.cells.y, row / (nx4 * push.cells.y) + channel * push.cells.z);
  imageStore(x, t, sum);
}

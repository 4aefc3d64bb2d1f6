// What the beams laid down, from units to W: packed like kappa (shared/diffusion.h).
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/beam.h"
layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant, scalar) uniform Constants { BeamPush push; };
layout(binding = 0, scalar) readonly buffer Deposits { uint deposits[]; };  // [channel][cell], low words
layout(binding = 1, scalar) readonly buffer Carries { uint carries[]; };    // high words
layout(binding = 2, rgba32f) uniform writeonly image3D power;               // W

void main() {
  const ivec3 t = ivec3(gl_GlobalInvocationID);
  if (4 * t.x >= push.cells.x || t.y >= push.cells.y) return;
  vec4 units;
  for (int lane = 0; lane < 4; ++lane) {
    const uint at = uint(4 * t.x + lane + push.cells.x * (t.y + push.cells.y * t.z));
    units[lane] = float(deposits[at]) + 4294967296.0 * float(carries[at]);
  }
  imageStore(power, t, push.unit[t.z / push.cells.z] * units);
}

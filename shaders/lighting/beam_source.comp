// What the beams laid down, from units to W: packed like kappa (shared/diffusion.h). And of what view rays see of it the share that
// was there before surfaces' light came in: light of lamps and sky, not scattered before.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/beam.h"
layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant, scalar) uniform Constants { BeamPush push; };
layout(binding = 0, scalar) readonly buffer Deposits { uint deposits[]; };  // [layer][channel][cell], low words
layout(binding = 1, scalar) readonly buffer Carries { uint carries[]; };    // high words
layout(binding = 2, rgba32f) uniform writeonly image3D power;               // W: deep
layout(binding = 3, rgba32f) uniform image3D seen;                          // W: deep and shallow
layout(binding = 4, rgba8) uniform writeonly image3D unscattered;

void main() {
  const ivec3 t = ivec3(gl_GlobalInvocationID);
  if (4 * t.x >= push.cells.x || t.y >= push.cells.y) return;
  vec4 watts[BEAM_LAYERS];
  for (int k = 0; k < BEAM_LAYERS; ++k)
    for (int lane = 0; lane < 4; ++lane) {
      const int z = t.z + k * push.channels * push.cells.z;
      const uint at = uint(4 * t.x + lane + push.cells.x * (t.y + push.cells.y * z));
      watts[k][lane] = push.unit[t.z / push.cells.z] * (float(deposits[at]) + 4294967296.0 * float(carries[at]));
    }
  const vec4 now = watts[BEAM_DEEP] + watts[BEAM_SHALLOW], before = push.sky.only_known != 0 ? imageLoad(seen, t) : now;
  imageStore(power, t, watts[BEAM_DEEP]);
  imageStore(seen, t, now);
  imageStore(unscattered, t, mix(vec4(1), min(before / max(now, vec4(1e-37)), 1), greaterThan(now, vec4(0))));
}

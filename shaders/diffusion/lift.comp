// x += Z c: islands' cells are lifted by what islands.comp found. x is high + low (update.comp).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/lift.glsl"
layout(binding = 7, rgba32f) uniform image3D high;
layout(binding = 8, rgba32f) uniform image3D low;

void main() {
  ivec3 t = texel_here();
  vec4 old = imageLoad(high, t);
  precise vec4 rest = imageLoad(low, t) + lift_at(t);
  precise vec4 sum = old + rest;
  precise vec4 lost = rest - (sum - old);
  imageStore(high, t, sum);
  imageStore(low, t, lost);
}

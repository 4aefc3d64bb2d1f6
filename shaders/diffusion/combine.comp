// x = kept + step x: what two visits of a level bring together
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
layout(binding = 6, rgba32f) uniform image3D x;
layout(binding = 7, rgba32f) uniform readonly image3D kept;

void main() {
  ivec3 t = texel_here();
  imageStore(x, t, imageLoad(kept, t) + push.step * imageLoad(x, t));
}

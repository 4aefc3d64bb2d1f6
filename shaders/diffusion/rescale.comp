// The solution of before in this light's unit of fluence: a power of two, so nothing is rounded.
#version 460
#extension GL_GOOGLE_include_directive : require
#define LEVEL_PUSH SurfacePush
#include "diffusion/level.glsl"
layout(binding = 5, scalar) readonly buffer Scales { FluenceScale scales[]; };
layout(binding = 7, rgba32f) uniform image3D high;
layout(binding = 8, rgba32f) uniform image3D low;

void main() {
  ivec3 t = texel_here();
  float ratio = scales[channel_here()].ratio;
  imageStore(high, t, ratio * imageLoad(high, t));
  imageStore(low, t, ratio * imageLoad(low, t));
}

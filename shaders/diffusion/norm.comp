// x . x on the finest level
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/partial.glsl"
layout(binding = 2, rgba32f) uniform readonly image3D x;

void main() {
  vec4 value = imageLoad(x, texel_here());
  leave_partial(dot(value, value));
}

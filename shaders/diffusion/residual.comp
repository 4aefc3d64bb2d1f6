// residual = b - A x
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/apply.glsl"
layout(binding = 5, rgba32f) uniform readonly image3D b;
layout(binding = 6, rgba32f) uniform writeonly image3D residual;

void main() {
  ivec3 t = texel_here();
  imageStore(residual, t, imageLoad(b, t) - apply(t));
}

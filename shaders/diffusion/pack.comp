// The packed stencil of the finest level, from the stencil and the reciprocal l1 norms, which are bf16 numbers already.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/stencil.glsl"
#include "diffusion/bf16.glsl"
layout(binding = 4, rgba32f) uniform readonly image3D inverse_l1;
layout(binding = 5, rgba32ui) uniform writeonly uimage3D pairs;

void store(int k, ivec3 t, vec4 low, vec4 high) {
  imageStore(pairs, t + k * texels(push.cells.x) * step_x, rounded_bits(low) >> 16 | rounded_bits(high));
}

void main() {
  ivec3 t = texel_here();
  if (t.x >= texels(push.cells.x)) return;
  vec4 face = coefficient(0, t);
  store(0, t, face, shifted_right(face, coefficient_right(0, t)));
  store(1, t, coefficient(1, t), coefficient(1, t + step_y));
  store(2, t, coefficient(2, t), coefficient(2, t + step_z));
  store(DIFFUSION_REACTION, t, coefficient(DIFFUSION_REACTION, t), imageLoad(inverse_l1, t));
}

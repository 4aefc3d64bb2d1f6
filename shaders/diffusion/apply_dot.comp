// product = A x on the finest level, and x . product
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/apply.glsl"
#include "diffusion/partial.glsl"
layout(binding = 6, rgba32f) uniform writeonly image3D product;

void main() {
  ivec3 t = texel_here();
  Star s = star_of_x(t);
  vec4 y = apply_to(s, t);
  imageStore(product, t, y);
  leave_partial(dot(s.own, y));
}

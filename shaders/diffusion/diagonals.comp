// Of every row: the reciprocal of its l1 norm (zero where no cell is) and, on the finest level, the diagonal.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/stencil.glsl"
layout(binding = 4, rgba32f) uniform writeonly image3D inverse_l1;
layout(binding = 5, rgba32f) uniform writeonly image3D diagonal;

vec4 faces(ivec3 t) {
  vec4 x = coefficient(0, t);
  return x + shifted_right(x, coefficient(0, t + step_x)) + coefficient(1, t) + coefficient(1, t + step_y) +
         coefficient(2, t) + coefficient(2, t + step_z);
}

vec4 couplings(ivec3 t) {
  vec4 sum = vec4(0);
  ivec4 x = 4 * t.x + ivec4(0, 1, 2, 3);
  for (int k = 0; k < DIFFUSION_DIAGONAL; ++k) {
    ivec3 d = offset(k), s = t - ivec3(0, d.yz);
    vec4 own = coefficient(k, s);
    vec4 opposite = d.x == 0 ? own : d.x < 0 ? shifted_right(own, coefficient(k, s + step_x))
                                             : shifted_left(coefficient(k, s - step_x), own);
    sum += abs(coefficient(k, t)) + mix(vec4(0), abs(opposite), lessThan(uvec4(x - d.x), uvec4(push.cells.x)));
  }
  return sum;
}

void main() {
  ivec3 t = texel_here();
  vec4 own, others;
  if (finest != 0) {
    others = faces(t);
    own = others + coefficient(DIFFUSION_REACTION, t);
    imageStore(diagonal, t, own);
  } else {
    others = couplings(t);
    own = coefficient(DIFFUSION_DIAGONAL, t);
  }
  imageStore(inverse_l1, t, mix(vec4(0), 1 / (own + others), greaterThan(own, vec4(0))));
}

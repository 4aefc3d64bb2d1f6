// Of every row: the reciprocal of its l1 norm (zero where no cell is), the diagonal and the sum.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/stencil.glsl"
layout(binding = 4, rgba32f) uniform writeonly image3D inverse_l1;
layout(binding = 5, rgba32f) uniform writeonly image3D diagonal;
layout(binding = 6, rgba32f) uniform writeonly image3D row_sum;

void main() {
  ivec3 t = texel_here();
  vec4 own = coefficient(own_entry, t), others = vec4(0);
  imageStore(row_sum, t, own);
  for (int n = 0; n < 27; ++n) {
    if (!coupled(n)) continue;
    vec4 c = conductance(n, t);
    own += c;
    others += abs(c);
  }
  imageStore(diagonal, t, own);
  imageStore(inverse_l1, t, mix(vec4(0), 1 / (own + others), greaterThan(own, vec4(0))));
}

// Of every row: the reciprocal of its l1 norm (zero where no cell is; on the finest level a bf16 number, which is what
// the packed stencil can hold), the diagonal and the sum.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/stencil.glsl"
#include "diffusion/bf16.glsl"
layout(binding = 4, rgba32f) uniform writeonly image3D inverse_l1;
layout(binding = 5, rgba32f) uniform writeonly image3D diagonal;
layout(binding = 6, rgba32f) uniform writeonly image3D row_sum;

void main() {
  ivec3 t = texel_here();
  vec4 own = coefficient(own_entry, t), others = vec4(0);
  imageStore(row_sum, t, own);
  if (finest != 0) {
    vec4 face = coefficient(0, t);
    others = face + shifted_right(face, coefficient_right(0, t));
    others += coefficient(1, t) + coefficient(1, t + step_y) + coefficient(2, t) + coefficient(2, t + step_z);
    own += others;
  } else {
    for (int n = 0; n < 27; ++n) {
      if (n == 13) continue;
      vec4 c = conductance(n, t);
      own += c;
      others += abs(c);
    }
  }
  imageStore(diagonal, t, own);
  vec4 inverse = mix(vec4(0), 1 / (own + others), greaterThan(own, vec4(0)));
  imageStore(inverse_l1, t, finest != 0 ? uintBitsToFloat(rounded_bits(inverse)) : inverse);
}

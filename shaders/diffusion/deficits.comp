// What the interpolation weights of a fine cell lack to 1, by what is absorbed or lost to the surface on the way:
//   v = 1 - P 1,  v_i = (row_sum_i + sum c_ij v_j) / (row_sum_i + sum c_ij) over the neighbours i interpolates from.
// As a difference from 1 it would be lost to rounding. 1 where no cell is. From zero, each pass makes the cells right
// that have one odd coordinate more: three passes. With it the row sums of the coarse operator, P^T A P 1 = P^T (A 1 - A v), cancel
// nothing.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/stencil.glsl"
layout(binding = 2, rgba32f) uniform readonly image3D diagonal;
layout(binding = 4, rgba32f) uniform readonly image3D before;
layout(binding = 5, rgba32f) uniform writeonly image3D after;

struct Row {
  vec4 lower, here;
};

void add(inout Row row, vec4 c, vec4 from) {
  row.lower += max(c, 0);
  row.here += max(c, 0) * from;
}

const vec4 odd_x = vec4(0, 1, 0, 1);

void finest_row(inout Row row, ivec3 t, vec2 odd) {
  vec4 own = imageLoad(before, t), face = coefficient(0, t);
  add(row, odd_x * face, own.xxzz);
  add(row, odd_x * shifted_right(face, coefficient_right(0, t)), shifted_right(own, imageLoad(before, t + step_x)));
  add(row, odd.x * coefficient(1, t), imageLoad(before, t - step_y));
  add(row, odd.x * coefficient(1, t + step_y), imageLoad(before, t + step_y));
  add(row, odd.y * coefficient(2, t), imageLoad(before, t - step_z));
  add(row, odd.y * coefficient(2, t + step_z), imageLoad(before, t + step_z));
}

void coarse_row(inout Row row, ivec3 t, ivec2 odd) {
  for (int n = 0; n < 27; ++n) {
    if (n == 13) continue;
    ivec3 e = offset(n), s = t + ivec3(0, e.yz * odd);
    vec4 own = imageLoad(before, s), from = own;
    if (e.x < 0) from = own.xxzz;  // lanes at odd x only
    if (e.x > 0) from = vec4(own.x, own.z, own.z, imageLoad(before, s + step_x).x);
    add(row, (s != t ? vec4(1) : abs(e.x) * odd_x) * conductance(n, t), from);
  }
}

void main() {
  ivec3 t = texel_here();
  ivec2 odd = ivec2(t.y, t.z - channel_here() * push.cells.z) & 1;
  vec4 row_sum = max(coefficient(own_entry, t), 0), own = imageLoad(diagonal, t);
  Row row = Row(vec4(0), row_sum);
  if (finest != 0)
    finest_row(row, t, vec2(odd));
  else
    coarse_row(row, t, odd);
  bvec4 stands_alone = lessThanEqual(row.lower, DIFFUSION_CONNECTED * own);
  vec4 v = mix(row.here / (row_sum + row.lower), vec4(0), stands_alone);
  imageStore(after, t, mix(v, vec4(1), lessThanEqual(own, vec4(0))));
}

// What the interpolation weights of a fine cell lack to 1, by what is absorbed or lost to the surface on the way:
//   v = 1 - P 1,  v_i = (row_sum_i + sum c_ij v_j) / (row_sum_i + sum c_ij) over the neighbours i interpolates from.
// As a difference from 1 it would be lost to rounding. 1 where no cell is. Each pass makes the cells right that have one
// odd coordinate more: four passes. With it the row sums of the coarse operator, P^T A P 1 = P^T (A 1 - A v), cancel
// nothing.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/stencil.glsl"
layout(binding = 2, rgba32f) uniform readonly image3D diagonal;
layout(binding = 4, rgba32f) uniform readonly image3D before;
layout(binding = 5, rgba32f) uniform writeonly image3D after;

void main() {
  ivec3 t = texel_here();
  ivec2 odd = ivec2(t.y, t.z - channel_here() * push.cells.z) & 1;
  vec4 row_sum = max(coefficient(own_entry, t), 0), lower = vec4(0), here = row_sum;
  for (int n = 0; n < 27; ++n) {
    if (!coupled(n)) continue;
    ivec3 e = offset(n), s = t + ivec3(0, e.yz * odd);
    vec4 own = imageLoad(before, s), from = own;
    if (e.x < 0) from = own.xxzz;  // lanes at odd x only
    if (e.x > 0) from = vec4(own.x, own.z, own.z, imageLoad(before, s + step_x).x);
    vec4 c = (s != t ? vec4(1) : abs(e.x) * vec4(0, 1, 0, 1)) * max(conductance(n, t), 0);
    lower += c;
    here += c * from;
  }
  vec4 centre = row_sum + lower, own = imageLoad(diagonal, t);
  bvec4 stands_alone = lessThanEqual(lower, DIFFUSION_CONNECTED * own);
  vec4 v = mix(here / centre, vec4(0), stands_alone);
  imageStore(after, t, mix(v, vec4(1), lessThanEqual(own, vec4(0))));
}

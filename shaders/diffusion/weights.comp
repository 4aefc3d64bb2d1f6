// Operator-dependent interpolation (Dendy 1982, black-box multigrid; three dimensions). A fine point with odd coordinates
// along some axes interpolates, by its own equation, from its neighbours with fewer odd coordinates within the span of
// those axes; along the other axes the stencil is collapsed, as if the solution were constant there: its centre is then
// the row's sum and the couplings to those neighbours, which cancels nothing. Couplings of the wrong sign, and row sums
// below zero, which coarse operators of sharp media have, count as none: with them the centre may all but vanish, and
// single precision with it. So weights are from 0 to 1. Points on no such neighbour (sheets and needles at odd index)
// stand for their own block: weight 1. deficits.comp follows the same rules.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/setup.glsl"
layout(binding = 6, rgba32f) uniform writeonly image3D weights;

// Points before those that interpolate from them: the coarse point, lines, planes, cubes.
const int order[DIFFUSION_WEIGHTS] = {13, 12, 14, 10, 16, 4,  22, 9, 11, 15, 17, 1,  7,  19,
                                      25, 3,  5,  21, 23, 0,  2,  6, 8,  18, 20, 24, 26};
shared float w[DIFFUSION_WEIGHTS * group_cells];

struct Row {
  float lower, here;
};

// Adds the conductance c to the point reached by e, as a part of the equation of point d.
void add(inout Row row, float c, ivec3 d, ivec3 e) {
  c = max(c, 0);
  ivec3 within = e * abs(d), from = d + within;
  bool stays = within == ivec3(0), known = !stays && all(lessThanEqual(abs(from), ivec3(1)));
  row.lower += stays ? 0 : c;
  row.here += known ? c * w[entry(known ? from : ivec3(0)) * group_cells + gl_LocalInvocationIndex] : 0;
}

float weight_of(ivec3 I, int channel, int k) {
  ivec3 d = offset(k), cell = 2 * I + d, i = cell + ivec3(0, 0, channel * push.cells.z);
  float own = in_grid(cell, push.cells) ? fine_diagonal(i) : 0;
  Row row = Row(0, 0);
  if (finest != 0) {
    for (int n = 0; n < 6; ++n) {
      ivec3 e = ivec3(0);
      e[n >> 1] = 2 * (n & 1) - 1;
      float c = e * d == ivec3(0) ? 0 : -coupling(i, e);
      add(row, c, d, e);
    }
  } else {
    for (int n = 0; n < 27; ++n) add(row, -coupling(i, offset(n)), d, offset(n));
  }
  float centre = max(fine_entry(own_entry, i), 0) + row.lower;
  bool orphan = row.lower <= DIFFUSION_CONNECTED * own;
  bool own_block = all(greaterThanEqual(d, ivec3(0)));
  return own <= 0 ? 0 : orphan ? (own_block ? 1 : 0) : row.here / centre;
}

void main() {
  ivec3 t = ivec3(gl_GlobalInvocationID);
  int channel = t.z / push.coarse_cells.z;
  ivec3 I = ivec3(t.xy, t.z - channel * push.coarse_cells.z);
  for (int n = 0; n < DIFFUSION_WEIGHTS; ++n) w[order[n] * group_cells + gl_LocalInvocationIndex] = weight_of(I, channel, order[n]);
  barrier();
  // Four cells a texel: invocation l stores texel l % 16 of the group, and every fourth entry.
  int nx4 = texels(push.coarse_cells.x);
  uint l = gl_LocalInvocationIndex, first = 4 * (l & 15);
  ivec3 texel = ivec3(gl_WorkGroupID.x * 4 + (l & 3), gl_WorkGroupID.y * 4 + (l >> 2 & 3), t.z);
  if (texel.x >= nx4) return;
  for (uint k = l >> 4; k < DIFFUSION_WEIGHTS; k += 4) {
    uint at = k * group_cells + first;
    imageStore(weights, texel + ivec3(k * nx4, 0, 0), vec4(w[at], w[at + 1], w[at + 2], w[at + 3]));
  }
}

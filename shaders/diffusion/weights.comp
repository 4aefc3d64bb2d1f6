// Operator-dependent interpolation (Dendy 1982, black-box multigrid; three dimensions). A fine point with odd coordinates
// along some axes interpolates, by its own equation, from its neighbours with fewer odd coordinates within the span of
// those axes; along the other axes the stencil is collapsed, as if the solution were constant there: its centre is then
// the row's sum and the couplings to those neighbours, which cancels nothing. Couplings of the wrong sign, and row sums
// below zero, which coarse operators of sharp media have, count as none: with them the centre may all but vanish, and
// single precision with it. So weights are from 0 to 1. Points on no such neighbour (sheets and needles at odd index)
// stand for their own block: weight 1. deficits.comp follows the same rules.
//
// An invocation has a texel of four coarse cells I and one entry, workgroup z from push.first in the order below; those
// with fewer odd coordinates are there already.
#version 460
#extension GL_GOOGLE_include_directive : require
#define LEVEL_PUSH WeightsPush
#include "diffusion/level.glsl"
#include "diffusion/setup.glsl"
layout(binding = 6, rgba32f) uniform image3D weights;

// The coarse point, lines, planes, cubes: 1, 6, 12, 8.
const int order[DIFFUSION_WEIGHTS] = {13, 12, 14, 10, 16, 4,  22, 9, 11, 15, 17, 1,  7,  19,
                                      25, 3,  5,  21, 23, 0,  2,  6, 8,  18, 20, 24, 26};

// -A(i, i + e) of the fine cells i = 2 I + (dx, ...), whose texels begin at t.
vec4 conductance(ivec3 t, int dx, ivec3 e) {
  int n = entry(e), k = finest != 0 ? abs(e.y) + 2 * abs(e.z) : min(n, 26 - n);
  bool upper = n > 13;
  vec4 c = at(line_of(k, t + (upper ? ivec3(0, e.yz) : ivec3(0))), upper ? dx + e.x : dx);
  return finest != 0 ? c : -c;
}

struct Row {
  vec4 lower, here;
};

// Adds the conductance towards e, as a part of the equation of point d.
void add(inout Row row, ivec3 coarse, ivec3 t, ivec3 d, ivec3 e) {
  ivec3 within = e * abs(d), from = d + within;
  bool moves = within != ivec3(0), known = moves && all(lessThanEqual(abs(from), ivec3(1)));
  vec4 c = float(moves) * max(conductance(t, d.x, e), 0);
  row.lower += c;
  row.here += float(known) * c *
              imageLoad(weights, coarse + entry(known ? from : ivec3(0)) * texels(push.coarse_cells.x) * step_x);
}

void main() {
  ivec3 coarse = texel_of(push.coarse_cells.z);
  int channel = channel_here(), nx4 = texels(push.coarse_cells.x), k = order[push.first + gl_WorkGroupID.z];
  if (coarse.x >= nx4) return;
  ivec3 d = offset(k), cell = ivec3(8 * coarse.x, 2 * coarse.yz + d.yz) - ivec3(0, 0, 2 * channel * push.coarse_cells.z);
  ivec3 t = ivec3(2 * coarse.x, cell.y, cell.z + channel * push.cells.z);
  bool row_in_grid = all(lessThan(uvec2(cell.yz), uvec2(push.cells.yz)));
  bvec4 in_grid = lessThan(uvec4(cell.x + d.x + ivec4(0, 2, 4, 6)), uvec4(row_in_grid ? push.cells.x : 0));
  vec4 own = mix(vec4(0), diagonal_at(t, d.x), in_grid);
  Row row = Row(vec4(0), vec4(0));
  if (finest != 0) {
    for (int axis = 0; axis < 3; ++axis)
      for (int side = -1; side <= 1; side += 2) {
        ivec3 e = ivec3(0);
        e[axis] = side;
        add(row, coarse, t, d, e);
      }
  } else {
    for (int n = 0; n < 27; ++n) add(row, coarse, t, d, offset(n));
  }
  vec4 centre = max(at(line_of(own_entry, t), d.x), 0) + row.lower;
  bvec4 orphan = lessThanEqual(row.lower, DIFFUSION_CONNECTED * own);
  float alone = float(all(greaterThanEqual(d, ivec3(0))));  // stands for its own block
  vec4 value = mix(row.here / centre, vec4(alone), orphan);
  imageStore(weights, coarse + k * nx4 * step_x, mix(value, vec4(0), lessThanEqual(own, vec4(0))));
}

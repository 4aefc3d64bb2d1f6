// The coarse operator P^T A P. An invocation has a texel of four coarse cells I and the three entries towards
// I + (-1..1, D), D = (-1..1, -1), (-1, 0): workgroup z. Rows of fine cells d (as seen from 2 I), their neighbours' rows
// d + e, and along x all that is within reach. With own_row D = (0, 0), and only the entry to the left: the rows' sums
// are made apart (deficits.comp) and taken over, the entry to the right is another texel's.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/setup.glsl"
layout(constant_id = 1) const int own_row = 0;  // a constant: a compiler leaves out what is not wanted
layout(binding = 6, rgba32f) uniform writeonly image3D coarse_stencil;
layout(binding = 7, rgba32f) uniform readonly image3D weights;
layout(binding = 8, rgba32f) uniform readonly image3D row_sums;  // of the coarse operator

vec4 weight(int k, ivec3 coarse_texel) {
  return imageLoad(weights, ivec3(k * texels(push.coarse_cells.x) + coarse_texel.x, coarse_texel.yz));
}

int row_entry(ivec2 d) { return 3 * (d.x + 1) + 9 * (d.y + 1); }  // with x-offset -1

struct Rows {
  ivec3 coarse, other, fine;  // texels of I, of I + (0, D), and of 2 I
  vec3 within;                // 1 where I + (-1..1, D) may lie in the grid
};

vec4 sums[3];  // towards I + (-1, D), I + (0, D), I + (1, D)

// Adds couplings[ex + 1][dx + 1] = A(i, i + (ex, e)) of the fine cells i = 2 I + (dx, d).
void add(Rows rows, vec4 couplings[3][3], ivec2 d, ivec2 j, int least, int most) {
  int k = row_entry(d), m = row_entry(j);
  vec4 own[3], other[3];
  for (int n = 0; n < 3; ++n) {
    own[n] = weight(k + n, rows.coarse);
    other[n] = weight(m + n, rows.other);
  }
  vec4 to_left[2] = {shifted_left(weight(m + 1, rows.other - step_x), other[1]),  // I - 1's own cell, and its next
                     shifted_left(weight(m + 2, rows.other - step_x), other[2])};
  vec4 to_right[2] = {shifted_right(other[0], weight(m, rows.other + step_x)),  // the one before I + 1's own, and that
                      shifted_right(other[1], weight(m + 1, rows.other + step_x))};
  // Beyond the grid another entry's weights lie.
  to_left[0].x *= rows.within.x, to_left[1].x *= rows.within.x;
  to_right[0].w *= rows.within.z, to_right[1].w *= rows.within.z;
  for (int ex = least; ex <= most; ++ex)
    for (int dx = -1; dx <= 1; ++dx) {
      int q = dx + ex;
      vec4 a = rows.within.y * own[dx + 1] * couplings[ex + 1][dx + 1];
      if (own_row == 0 && abs(q) <= 1) sums[1] += a * other[q + 1];
      if (q <= -1) sums[0] += a * to_left[q + 2];
      if (own_row == 0 && q >= 1) sums[2] += a * to_right[q - 1];
    }
}

// Couplings within the fine row d and to itself.
void add_along(Rows rows, ivec2 d, ivec2 D) {
  ivec3 t = rows.fine + ivec3(0, d);
  Line a = line_of(finest != 0 ? 0 : 12, t);
  float sign_ = finest != 0 ? -1 : 1;
  vec4 couplings[3][3];
  for (int dx = -1; dx <= 1; ++dx) {
    couplings[0][dx + 1] = sign_ * at(a, dx);
    couplings[1][dx + 1] = diagonal_at(t, dx);
    couplings[2][dx + 1] = sign_ * at(a, dx + 1);
  }
  add(rows, couplings, d, d - 2 * D, -1, 1);
}

// Couplings between the fine rows d and d + e, e not zero: as the upper of the two has them.
void add_across(Rows rows, ivec2 d, ivec2 e, ivec2 D) {
  bool upper = e.y > 0 || (e.y == 0 && e.x > 0);  // is d + e
  ivec3 t = rows.fine + ivec3(0, upper ? d + e : d);
  vec4 couplings[3][3];
  if (finest != 0) {
    Line a = line_of(abs(e.x) + 2 * abs(e.y), t);
    for (int dx = -1; dx <= 1; ++dx) couplings[1][dx + 1] = -at(a, dx);
    add(rows, couplings, d, d + e - 2 * D, 0, 0);
  } else {
    for (int ex = -1; ex <= 1; ++ex) {
      int n = row_entry(e) + ex + 1;
      Line a = line_of(upper ? 26 - n : n, t);
      for (int dx = -1; dx <= 1; ++dx) couplings[ex + 1][dx + 1] = upper ? at(a, dx + ex) : at(a, dx);
    }
    add(rows, couplings, d, d + e - 2 * D, -1, 1);
  }
}

void main() {
  ivec3 coarse = texel_of(push.coarse_cells.z);
  int channel = channel_here(), nx4 = texels(push.coarse_cells.x), group = own_row != 0 ? 4 : int(gl_WorkGroupID.z);
  if (coarse.x >= nx4) return;
  ivec2 D = ivec2(group % 3, group / 3) - 1;
  int layer = coarse.z - channel * push.coarse_cells.z;
  float within = float(uint(layer + D.y) < uint(push.coarse_cells.z));
  Rows rows = Rows(coarse, coarse + ivec3(0, D), ivec3(2 * coarse.xy, 2 * layer + channel * push.cells.z),
                   vec3(coarse.x > 0, within, coarse.x + 1 < nx4));
  for (int n = 0; n < 3; ++n) sums[n] = vec4(0);
  for (int ez = -1; ez <= 1; ++ez) {
    int reach = finest != 0 ? 1 - abs(ez) : 1;
    for (int ey = -reach; ey <= reach; ++ey) {
      ivec2 e = ivec2(ey, ez), low = max(ivec2(-1), 2 * D - 1 - e), high = min(ivec2(1), 2 * D + 1 - e);
      bool along = e == ivec2(0);
      for (int dz = low.y; dz <= high.y; ++dz) {  // one of the two is empty: a branch would cost both
        for (int dy = along ? low.x : 2; dy <= high.x; ++dy) add_along(rows, ivec2(dy, dz), D);
        for (int dy = along ? 2 : low.x; dy <= high.x; ++dy) add_across(rows, ivec2(dy, dz), e, D);
      }
    }
  }
  ivec3 stored = coarse + 3 * group * nx4 * step_x;
  imageStore(coarse_stencil, stored, sums[0]);
  imageStore(coarse_stencil, stored + nx4 * step_x, own_row != 0 ? imageLoad(row_sums, coarse) : sums[1]);
  if (own_row == 0) imageStore(coarse_stencil, stored + 2 * nx4 * step_x, sums[2]);
}

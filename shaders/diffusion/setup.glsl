// Set-up works cell by cell: an invocation has one coarse cell I of one channel. Where loops run and loads are made
// follows from arithmetic, not from branches: a CPU's vector lanes pay for both sides of a branch.
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"
layout(local_size_x = 16, local_size_y = 4) in;
layout(constant_id = 0) const int finest = 0;
layout(push_constant, scalar) uniform PushBlock { LevelPush push; };
layout(binding = 1, rgba32f) uniform readonly image3D stencil;
layout(binding = 2, rgba32f) uniform readonly image3D diagonal;

const uint group_cells = 64;
const int own_entry = finest != 0 ? DIFFUSION_REACTION : DIFFUSION_ROW_SUM;

int texels(int cells) { return (cells + 3) >> 2; }
ivec3 offset(int k) { return ivec3(k % 3, k / 3 % 3, k / 9) - 1; }
int entry(ivec3 d) { return (d.x + 1) + 3 * (d.y + 1) + 9 * (d.z + 1); }

// Stencil entry at a fine cell; cell.z counts through the channels. Outside the grid this may be another entry's value:
// what it is multiplied with is zero there.
float fine_entry(int k, ivec3 cell) {
  return imageLoad(stencil, ivec3(k * texels(push.cells.x) + (cell.x >> 2), cell.yz))[cell.x & 3];
}
float fine_diagonal(ivec3 cell) { return imageLoad(diagonal, ivec3(cell.x >> 2, cell.yz))[cell.x & 3]; }

// A(i, i + e), e not zero; on the finest level e is along an axis.
float coupling(ivec3 i, ivec3 e) {
  if (finest != 0) {
    int axis = abs(e.y) + 2 * abs(e.z);
    return -fine_entry(axis, i + max(e, ivec3(0)));
  }
  int k = entry(e);
  return fine_entry(min(k, 26 - k), k < 13 ? i : i + e);
}

bool in_grid(ivec3 cell, ivec3 cells) { return all(lessThan(uvec3(cell), uvec3(cells))); }

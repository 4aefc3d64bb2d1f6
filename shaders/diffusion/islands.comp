// Of every piece of an island (engine/diffusion/islands.h) its part of Z^T (r - A z), or with `start` of Z^T r; one subgroup
// a piece: most are small, and a barrier costs a CPU more than their sums. Flows within an island cancel in Z^T A z, so
// only its reaction and what crosses its boundary are summed, and nothing is lost to rounding. lifts.comp adds the pieces
// up.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
layout(local_size_x = 64) in;
layout(constant_id = 0) const int start = 0;
layout(push_constant, scalar) uniform PushBlock { IslandPush push; };
layout(binding = 0, scalar) readonly buffer Pieces { IslandPiece pieces[]; };
layout(binding = 1, scalar) readonly buffer Entries { uint entries[]; };
layout(binding = 2, scalar) writeonly buffer Sums { float sums[]; };  // of every piece
layout(binding = 3, rgba32f) uniform readonly image3D r;
layout(binding = 4, rgba32f) uniform readonly image3D z;
layout(binding = 5, rgba32f) uniform readonly image3D stencil;

float r_at(ivec3 c) { return imageLoad(r, ivec3(c.x >> 2, c.yz))[c.x & 3]; }
float z_at(ivec3 c) { return imageLoad(z, ivec3(c.x >> 2, c.yz))[c.x & 3]; }
float entry_at(int entry, ivec3 c) {
  return imageLoad(stencil, ivec3(entry * (push.cells.x >> 2) + (c.x >> 2), c.yz))[c.x & 3];
}

float share_of(uint packed_entry, int channel) {
  ivec3 c = ivec3(packed_entry & 511u, packed_entry >> 9 & 511u, (packed_entry >> 18 & 511u) + channel * push.cells.z);
  int kind = int(packed_entry >> 27);
  if (start != 0) return kind == DIFFUSION_ISLAND_CELL ? r_at(c) : 0;
  if (kind == DIFFUSION_ISLAND_CELL) return r_at(c) - entry_at(DIFFUSION_REACTION, c) * z_at(c);
  ivec3 beyond = c;
  beyond[kind >> 1] += 2 * (kind & 1) - 1;
  return entry_at(kind >> 1, max(c, beyond)) * (z_at(beyond) - z_at(c));
}

void main() {
  uint stride = gl_NumWorkGroups.x * gl_NumSubgroups;
  for (uint k = gl_WorkGroupID.x * gl_NumSubgroups + gl_SubgroupID; k < push.pieces; k += stride) {
    IslandPiece piece = pieces[k];
    float sum = 0;
    for (uint i = piece.begin + gl_SubgroupInvocationID; i < piece.end; i += gl_SubgroupSize)
      sum += share_of(entries[i], piece.channel);
    sum = subgroupAdd(sum);
    if (subgroupElect()) sums[k] = sum;
  }
}

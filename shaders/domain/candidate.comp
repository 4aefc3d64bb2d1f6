// What each candidate does to the apertures across its cell, whether it holds surface, and whether a slit parts it.
// One thread a candidate.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "sums.glsl"
#include "cells.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { DomainPush push; };
layout(binding = 3, scalar) readonly buffer List { uint list[]; };
layout(binding = 4, scalar) writeonly buffer Gifts { uint gifts[]; };
layout(binding = 5, scalar) buffer CutBits { uint cut_bits[]; };
layout(binding = 6, scalar) buffer Status { DomainStatus status; };
layout(binding = 7, scalar) writeonly buffer Faces { ivec4 faces[]; };  // by axis: integral n_axis (1, x) dA

layout(binding = 8, scalar) buffer SlitBits { uint slit_bits[]; };  // by texel: it has faces of a cell that gives

void mark_faces(ivec3 cell) {  // its low ones and, through its upper neighbours, its high ones
  for (int i = -1; i < 3; ++i) {
    ivec3 owner = cell;
    if (i >= 0) owner[i] += 1;
    uint texel = cell_index(owner, push.cells) / 4u;
    atomicOr(slit_bits[texel >> 5], 1u << (texel & 31u));
  }
}

void mark(uint c) { atomicOr(cut_bits[c >> 5], 1u << (c & 31u)); }

uint find_gift(uint rank) {
  float widest = least_sheet;
  uint gift = 0u;
  for (int axis = 0; axis < 3; ++axis) {
    float end = sum_of(rank, 2 * axis, sum_A + axis), begin = sum_of(rank, 2 * axis + 1, sum_A + axis);
    float narrower = min(end, -begin);
    if (narrower <= widest) continue;
    float end_at = sum_of(rank, 2 * axis, sum_M + 4 * axis) / end;
    float begin_at = sum_of(rank, 2 * axis + 1, sum_M + 4 * axis) / begin;
    if (begin_at <= end_at) continue;
    widest = narrower;
    gift = 1u + uint(2 * axis) + (end_at + begin_at > 1.0 ? 1u : 0u);
  }
  return gift;
}

void write_faces(uint rank) {
  for (int axis = 0; axis < 3; ++axis) {
    ivec4 sum = ivec4(0);
    for (uint kind = 0u; kind < 6u; ++kind) {
      uint at = (6u * rank + kind) * sum_count;
      uint m = at + sum_M + 3 * axis;
      sum += ivec4(sums[at + sum_A + axis], sums[m], sums[m + 1u], sums[m + 2u]);
    }
    faces[3u * rank + uint(axis)] = sum;
  }
}

void main() {
  uint rank = gl_GlobalInvocationID.x;
  if (rank >= push.count) return;
  write_faces(rank);
  float S = 0.0;
  bool overflow = false;
  for (int kind = 0; kind < 6; ++kind) {
    float part = sum_of(rank, kind, sum_S);
    overflow = overflow || part < -1.0 || part > 100.0;
    S += part;
  }
  if (overflow) atomicAdd(status.crumpled_cells, 1u);
  uint gift = S < least_facet ? 0u : find_gift(rank);
  gifts[rank] = gift;
  if (S < least_facet) return;
  mark(list[rank]);
  if (gift == 0u) return;
  atomicAdd(status.slit_cells, 1u);
  ivec3 taker = cell_at(list[rank], push.cells);
  mark_faces(taker);
  taker[(gift - 1u) / 2u] += (gift - 1u) % 2u == 1u ? 1 : -1;
  mark(cell_index(taker, push.cells));
}

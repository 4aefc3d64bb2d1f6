// Dense fields, four x-neighbours a texel: volume fractions, final apertures, cut-cell indices, and which tiles are
// active. One thread a texel.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "sums.glsl"
#include "cells.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const int parted = 1;  // 0 where no cell gives anything
layout(push_constant, scalar) uniform Push { DomainPush push; };
layout(binding = 3, scalar) readonly buffer CutBits { uint cut_bits[]; };
layout(binding = 4, scalar) readonly buffer CutBefore { uint cut_before[]; };
layout(binding = 5, scalar) readonly buffer Gifts { uint gifts[]; };
layout(binding = 6, scalar) readonly buffer CutCells { GpuCutCell cut_cells[]; };
layout(binding = 7, scalar) buffer Status { DomainStatus status; };
layout(binding = 8, scalar) buffer TileBits { uint tile_bits[]; };
layout(binding = 9, rgba32f) uniform image3D aperture_x;
layout(binding = 10, rgba32f) uniform image3D aperture_y;
layout(binding = 11, rgba32f) uniform image3D aperture_z;
layout(binding = 12, rgba32f) uniform writeonly image3D volume;
layout(binding = 13, r32ui) uniform writeonly uimage3D cut_index;

shared uint inner, overlaps, inverted;

// What the cell's low face across `axis` loses to gifts.
float closed_by_gifts(ivec3 cell, int axis) {
  float closed = 0.0;
  for (int kind = 2 * axis; kind <= 2 * axis + 1; ++kind) {
    ivec3 giver = cell;
    giver[axis] -= kind % 2;  // class 2 * axis goes down from this cell, 2 * axis + 1 up from the one below
    uint rank = candidate(giver, push.cells);
    if (rank != none && gifts[rank] == uint(kind + 1)) closed += abs(sum_of(rank, kind, sum_A + axis));
  }
  return closed;
}

vec4 finished(vec4 open, ivec3 cell, int axis, uint four) {
  if (any(greaterThan(open, vec4(1.001)))) atomicAdd(overlaps, 1u);
  if (any(lessThan(open, vec4(-0.001)))) atomicAdd(inverted, 1u);
  if (parted == 1 && four != 0u) {
    for (int k = 0; k < 4; ++k) open[k] -= closed_by_gifts(cell + ivec3(k, 0, 0), axis);
  }
  return mix(mix(open, vec4(1), greaterThan(open, vec4(1.0 - face_snap))), vec4(0), lessThan(open, vec4(face_snap)));
}

void fill_texel(ivec3 texel) {
  ivec3 cell = ivec3(4 * texel.x, texel.yz);
  uint c = cell_index(cell, push.cells), word = cut_bits[c >> 5];
  uint four = word >> (c & 31u) & 15u;
  vec4 x = imageLoad(aperture_x, texel), v;
  for (int k = 0; k < 4; ++k) {
    uint index = 0u;
    v[k] = x[k] > 0.5 ? 1.0 : 0.0;
    if ((four >> k & 1u) != 0u) {
      index = 1u + rank_of(word, cut_before[c >> 5], (c & 31u) + uint(k));
      v[k] = cut_cells[index].volume;
    } else if (v[k] > 0.0) {
      atomicAdd(inner, 1u);
    }
    imageStore(cut_index, cell + ivec3(k, 0, 0), uvec4(index));
  }
  imageStore(volume, texel, v);
  imageStore(aperture_x, texel, finished(x, cell, 0, four));
  imageStore(aperture_y, texel, finished(imageLoad(aperture_y, texel), cell, 1, four));
  imageStore(aperture_z, texel, finished(imageLoad(aperture_z, texel), cell, 2, four));
  if (any(greaterThan(v, vec4(0)))) {
    ivec2 tiles = (push.cells.xy + ivec2(tile_size_x, tile_size_y) - 1) / ivec2(tile_size_x, tile_size_y);
    ivec2 tile = cell.xy / ivec2(tile_size_x, tile_size_y);
    uint t = uint(tile.x + tiles.x * (tile.y + tiles.y * cell.z));
    atomicOr(tile_bits[t >> 5], 1u << (t & 31u));
  }
}

void main() {
  if (gl_LocalInvocationIndex == 0u) {
    inner = 0u;
    overlaps = 0u;
    inverted = 0u;
  }
  barrier();
  ivec3 texel = ivec3(gl_GlobalInvocationID);
  if (texel.x < push.cells.x / 4 && texel.y < push.cells.y) fill_texel(texel);
  barrier();
  if (gl_LocalInvocationIndex == 0u) {
    atomicAdd(status.inner_cells, inner);
    atomicAdd(status.overlapping_texels, overlaps);
    atomicAdd(status.inverted_texels, inverted);
  }
}

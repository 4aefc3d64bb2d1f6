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
layout(binding = 6, scalar) readonly buffer Faces { ivec4 faces[]; };
layout(binding = 7, scalar) readonly buffer CutCells { GpuCutCell cut_cells[]; };
layout(binding = 8, scalar) buffer Status { DomainStatus status; };
layout(binding = 9, scalar) buffer TileBits { uint tile_bits[]; };
layout(binding = 10, rgba32f) uniform image3D aperture_x;
layout(binding = 11, rgba32f) uniform image3D aperture_y;
layout(binding = 12, rgba32f) uniform image3D aperture_z;
layout(binding = 13, rgba32f) uniform writeonly image3D volume;
layout(binding = 14, r32ui) uniform writeonly uimage3D cut_index;

shared uint inner, overlaps, inverted;

// Whether x lies on the solid side of a sheet.
bool behind(vec3 x, uint rank, int kind) {
  return dot(x - sum3_of(rank, kind, sum_X) / sum_of(rank, kind, sum_S), sum3_of(rank, kind, sum_A)) < 0.0;
}

// What is left open of the cell's low face across `axis` where slits part the cells on its two sides (twin:
// faces_between_pieces in engine/domain/cut_cells.cpp).
float parted_face(float open, ivec3 cell, int axis) {
  ivec3 below = cell;
  below[axis] -= 1;
  uint high = candidate(cell, push.cells), low = below[axis] < 0 ? none : candidate(below, push.cells);
  uint gift_high = high != none ? gifts[high] : 0u, gift_low = low != none ? gifts[low] : 0u;
  if (gift_high == 0u && gift_low == 0u) return open;
  if (gift_high != 0u && gift_low != 0u) {
    vec3 kept_high = sum3_of(high, int(gift_high - 1u) ^ 1, sum_A);
    vec3 kept_low = sum3_of(low, int(gift_low - 1u) ^ 1, sum_A);
    if (dot(kept_high, kept_low) < 0.0) return 0.0;
  } else {
    vec3 centre = vec3(0.5);
    if (high != none && open >= face_snap) {
      ivec4 face = faces[3u * high + uint(axis)];
      centre = vec3(face.yzw) / float(face.x);
    }
    centre[axis] = gift_high != 0u ? 0.0 : 1.0;
    uint rank = gift_high != 0u ? high : low;
    int gone = int(max(gift_high, gift_low)) - 1;
    if (behind(centre, rank, gone) && !behind(centre, rank, gone ^ 1)) return 0.0;
  }
  if (gift_high == uint(2 * axis + 1)) open -= abs(sum_of(high, 2 * axis, sum_A + axis));
  if (gift_low == uint(2 * axis + 2)) open -= abs(sum_of(low, 2 * axis + 1, sum_A + axis));
  return open;
}

vec4 finished(vec4 open, ivec3 cell, int axis) {
  if (any(greaterThan(open, vec4(1.001)))) atomicAdd(overlaps, 1u);
  if (any(lessThan(open, vec4(-0.001)))) atomicAdd(inverted, 1u);
  if (parted == 1) {
    for (int k = 0; k < 4; ++k) open[k] = parted_face(open[k], cell + ivec3(k, 0, 0), axis);
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
  imageStore(aperture_x, texel, finished(x, cell, 0));
  imageStore(aperture_y, texel, finished(imageLoad(aperture_y, texel), cell, 1));
  imageStore(aperture_z, texel, finished(imageLoad(aperture_z, texel), cell, 2));
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

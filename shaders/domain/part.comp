// Closes the faces between the two sides of a slit, after dense.comp has read the inner cells off the apertures. One thread a texel of four x-neighbours, of those near a slit.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "sums.glsl"
#include "cells.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { DomainPush push; };
layout(binding = 3, scalar) readonly buffer List { uint list[]; };
layout(binding = 4, scalar) readonly buffer Gifts { uint gifts[]; };
layout(binding = 5, scalar) readonly buffer Faces { ivec4 faces[]; };
layout(binding = 6, rgba32f) uniform image3D aperture_x;
layout(binding = 7, rgba32f) uniform image3D aperture_y;
layout(binding = 8, rgba32f) uniform image3D aperture_z;

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
  return open < face_snap ? 0.0 : open;
}

vec4 parted(vec4 open, ivec3 cell, int axis) {
  for (int k = 0; k < 4; ++k) open[k] = parted_face(open[k], cell + ivec3(k, 0, 0), axis);
  return open;
}

void main() {
  if (gl_GlobalInvocationID.x >= push.count) return;
  ivec3 cell = cell_at(4u * list[gl_GlobalInvocationID.x], push.cells);
  ivec3 texel = ivec3(cell.x / 4, cell.yz);
  imageStore(aperture_x, texel, parted(imageLoad(aperture_x, texel), cell, 0));
  imageStore(aperture_y, texel, parted(imageLoad(aperture_y, texel), cell, 1));
  imageStore(aperture_z, texel, parted(imageLoad(aperture_z, texel), cell, 2));
}

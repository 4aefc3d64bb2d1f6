// Dense fields, four x-neighbours a texel: volume fractions, final apertures and cut-cell indices. One thread a
// texel.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "sums.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant, scalar) uniform Push { DomainPush push; };
layout(binding = 0, scalar) readonly buffer CutBits { uint cut_bits[]; };
layout(binding = 1, scalar) readonly buffer CutBefore { uint cut_before[]; };
layout(binding = 2, scalar) readonly buffer CutCells { GpuCutCell cut_cells[]; };
layout(binding = 3, scalar) buffer Status { DomainStatus status; };
layout(binding = 5, rgba32f) uniform image3D aperture_x;
layout(binding = 6, rgba32f) uniform image3D aperture_y;
layout(binding = 7, rgba32f) uniform image3D aperture_z;
layout(binding = 8, rgba32f) uniform writeonly image3D volume;
layout(binding = 9, r32ui) uniform writeonly uimage3D cut_index;

shared uint inner, overlaps, inverted;

vec4 finished(vec4 open) {
  if (any(greaterThan(open, vec4(1.001)))) atomicAdd(overlaps, 1u);
  if (any(lessThan(open, vec4(-0.001)))) atomicAdd(inverted, 1u);
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
  imageStore(aperture_x, texel, finished(x));
  imageStore(aperture_y, texel, finished(imageLoad(aperture_y, texel)));
  imageStore(aperture_z, texel, finished(imageLoad(aperture_z, texel)));
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

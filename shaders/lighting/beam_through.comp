// What leaves unscattered through each side of each cut cell, from units to W/m^2. Beams meet slivers by chance, and what sees
// a sliver sees all around it, too: so the power is spread evenly over the facets around that look the same way,
//   through_i = sum_j w_ij P_j / D_j,  D_j = sum_i w_ij S_i,  w_ij = max(0, n_i . n_j) over the 27 cells around,
// by which none is lost. First pass: P_j / D_j; second: the sum.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/beam.h"
#include "shared/domain.h"
layout(local_size_x = 64) in;
layout(constant_id = 0) const int second = 0;
layout(push_constant, scalar) uniform Constants { BeamPush push; };
layout(binding = 0, scalar) readonly buffer Leaving { uint leaving[]; };  // units, [entry][channel], low words, then high words
layout(binding = 1, scalar) readonly buffer CutCells { GpuCutCell cut_cells[]; };
layout(binding = 2, r32ui) uniform readonly uimage3D cut_index;
layout(binding = 3, scalar) buffer Shares { vec3 shares[]; };              // P / D, W/m^2, two a cut cell
layout(binding = 4, scalar) writeonly buffer Through { vec3 through[]; };  // W/m^2, two a cut cell

vec3 normal_of(uint entry) {
  const vec3 v = cut_cells[entry / 2].side[entry % 2].area_vector;
  return v / max(length(v), 1e-30);
}

vec3 power_of(uint entry) {
  vec3 watts;
  for (uint c = 0; c < 3; ++c) {
    const uint k = 3 * entry + min(c, uint(push.channels) - 1);
    watts[c] = push.unit[c] * (float(leaving[k]) + 4294967296.0 * float(leaving[6 * uint(push.count) + k]));
  }
  return watts;
}

void main() {
  const uint entry = gl_GlobalInvocationID.x;
  if (entry >= 2 * uint(push.count)) return;
  const vec3 power = second == 0 ? power_of(entry) : vec3(0);
  const bool there = entry > 1 && cut_cells[entry / 2].side[entry % 2].area > 0;
  const bool wanted = there && (second != 0 || power != vec3(0));
  const vec3 normal = normal_of(entry);
  float area = 0;
  vec3 sum = vec3(0);
  for (int n = wanted ? 0 : 27; n < 27; ++n) {
    const uint index = imageLoad(cut_index, cut_cells[entry / 2].cell + ivec3(n % 3, n / 3 % 3, n / 9) - 1).r;
    for (uint other = 2 * index; index != 0 && other < 2 * index + 2; ++other) {
      const float size = cut_cells[index].side[other % 2].area;
      const float weight = other == entry ? 1 : size > 0 ? max(0, dot(normal, normal_of(other))) : 0;
      area += weight * size;
      if (second != 0) sum += weight * shares[other];
    }
  }
  if (second == 0)
    shares[entry] = area > 0 ? power / (area * push.h * push.h) : vec3(0);
  else
    through[entry] = sum;
}

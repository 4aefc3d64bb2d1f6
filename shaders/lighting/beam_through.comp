// What leaves unscattered through each side of each cut cell, from units to W/m^2.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/beam.h"
#include "shared/domain.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { BeamPush push; };
layout(binding = 0, scalar) readonly buffer Leaving { uint leaving[]; };  // units, [entry][channel], low words, then high words
layout(binding = 1, scalar) readonly buffer CutCells { GpuCutCell cut_cells[]; };
layout(binding = 2, scalar) writeonly buffer Through { vec3 through[]; };  // two a cut cell

void main() {
  const uint entry = gl_GlobalInvocationID.x, entries = 2 * uint(push.count);
  if (entry >= entries) return;
  const float area = cut_cells[entry / 2].side[entry % 2].area * push.h * push.h;
  vec3 flux = vec3(0);
  for (uint c = 0; c < 3 && area > 0; ++c) {
    const uint k = 3 * entry + min(c, uint(push.channels) - 1);
    flux[c] = push.unit[c] / area * (float(leaving[k]) + 4294967296.0 * float(leaving[3 * entries + k]));
  }
  through[entry] = flux;
}

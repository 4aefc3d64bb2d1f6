// Gamma_s of each cut cell: the light that enters at its two sides, averaged by area, times exp(-sigma_a / sigma_s').
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"
#include "shared/domain.h"
#include "shared/lighting.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { FacetPush push; };
layout(binding = 0, scalar) readonly buffer CutCells { GpuCutCell cut_cells[]; };
layout(binding = 1, scalar) readonly buffer Flux { vec3 flux[]; };        // W/m^2, two a cut cell
layout(binding = 2, scalar) readonly buffer Media { FacetMedium media[]; };  // one a cut cell
layout(binding = 3, scalar) writeonly buffer GammaS { vec3 gamma_s[]; };  // W/m^2, one a cut cell
void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.cut_cells) return;
  float a0 = cut_cells[i].side[0].area, a1 = cut_cells[i].side[1].area;
  vec3 sum = (a0 > 0.0 ? a0 * flux[2 * i] : vec3(0.0)) + (a1 > 0.0 ? a1 * flux[2 * i + 1] : vec3(0.0));
  gamma_s[i] = a0 + a1 > 0.0 ? media[i].reduced_intensity * sum / (a0 + a1) : vec3(0.0);
}

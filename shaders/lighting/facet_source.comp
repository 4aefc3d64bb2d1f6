// Gamma_s of each cut cell: the light that enters at its two sides times exp(-sigma_a / sigma_s'), and the two averaged by
// area.
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
layout(binding = 3, scalar) writeonly buffer GammaS { vec3 gamma_s[]; };        // W/m^2, one a cut cell
layout(binding = 4, scalar) writeonly buffer SideGammaS { vec3 side_gamma_s[]; };  // two
void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.cut_cells) return;
  float a0 = cut_cells[i].side[0].area, a1 = cut_cells[i].side[1].area;
  vec3 up = a0 > 0.0 ? media[i].reduced_intensity * flux[2 * i] : vec3(0.0);
  vec3 down = a1 > 0.0 ? media[i].reduced_intensity * flux[2 * i + 1] : vec3(0.0);
  side_gamma_s[2 * i] = up;
  side_gamma_s[2 * i + 1] = down;
  gamma_s[i] = a0 + a1 > 0.0 ? (a0 * up + a1 * down) / (a0 + a1) : vec3(0.0);
}

// Gamma_s of the two sides of each cut cell: the light that enters there times exp(-sigma_a / sigma_s').
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"
#include "shared/lighting.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { FacetPush push; };
layout(binding = 0, scalar) readonly buffer Flux { vec3 flux[]; };         // W/m^2, two a cut cell
layout(binding = 1, scalar) readonly buffer Media { FacetMedium media[]; };  // one a cut cell
layout(binding = 2, scalar) writeonly buffer GammaS { vec3 gamma_s[]; };   // W/m^2, two a cut cell
void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < 2 * push.cut_cells) gamma_s[i] = media[i / 2].reduced_intensity * flux[i];
}

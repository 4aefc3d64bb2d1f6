// Scales the flux of single scattering on all facets, so that all together it is what the picture draws.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/single.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { SingleScalePush push; };
layout(binding = 0, scalar) buffer Single { vec4 single_flux[]; };  // W/m^2, two a cut cell

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i < push.sides) single_flux[i].rgb *= push.scale;
}

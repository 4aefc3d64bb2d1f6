// Takes what leaves after one scattering, s, out of Gamma_s, and adds it to what the query sends out at once (Gamma_q =
// Gamma_s - A s is a flux s on top of the report's). A half space sends back the share R of its Gamma_s: taking s / R out of it
// leaves the sum as it was. Without absorption R = 1.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"
#include "shared/single.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { SingleFluxPush push; };
layout(binding = 0, scalar) readonly buffer Single { vec4 single_flux[]; };        // W/m^2, two a cut cell
layout(binding = 1, scalar) readonly buffer Media { FacetMedium media[]; };        // one a cut cell
layout(binding = 2, scalar) buffer GammaS { vec3 gamma_s[]; };                     // W/m^2, two a cut cell
layout(binding = 3, scalar) writeonly buffer QueryGamma { vec3 query_gamma[]; };
layout(binding = 4, scalar) writeonly buffer Entered { vec3 entered[]; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.sides) return;
  const vec3 leaves = single_flux[i].rgb;
  const FacetMedium medium = media[i / 2];
  vec3 gamma = gamma_s[i];
  for (int c = 0; c < 3; ++c) gamma[c] = gamma_beside_single(gamma[c], leaves[c], medium.kappa[c], medium.sigma_a[c], push.A);
  gamma_s[i] = gamma;
  entered[i] = gamma + leaves;
  query_gamma[i] = gamma - push.A * leaves;
}

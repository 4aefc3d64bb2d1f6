// Flux that leaves the two sides of each cut cell after one scattering, below a plane: of the light of every sample its share
// by the refracted cosine (SingleScattering's table) times the albedo.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"
#include "shared/single.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { SingleFluxPush push; };
#include "lighting/arrivals.glsl"
layout(binding = 3, scalar) readonly buffer Receivers { Receiver receivers[]; };  // two a cut cell
layout(binding = 4, scalar) readonly buffer Media { FacetMedium media[]; };       // one a cut cell
layout(binding = 5, scalar) readonly buffer Shares { float shares[]; };           // SINGLE_TABLE, of an albedo of 1
layout(binding = 6, scalar) writeonly buffer Single { vec4 single_flux[]; };      // W/m^2, two a cut cell

float share(float mu) {
  const float at = sqrt(clamp(mu, 0, 1)) * (SINGLE_TABLE - 1);
  const int low = min(int(at), SINGLE_TABLE - 2);
  return mix(shares[low], shares[low + 1], at - float(low));
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.sides) return;
  single_flux[i] = vec4(0);
  const Receiver receiver = receivers[i];
  if (i < 2 || receiver.normal == vec3(0)) return;
  const Sky sky = sky_over(i, receiver, push.eta, push.f_dt_outer);
  vec3 sum = vec3(0);
  for (uint k = 0; k < arrivals(); ++k) {
    const Arrival light = arrival(k, receiver, push.eta, sky);
    if (light.cosine > 0) sum += light.flux * share(refracted_cosine(light.cosine, push.eta));
  }
  for (int c = 0; c < 3; ++c) sum[c] *= true_albedo(media[i / 2].kappa[c], media[i / 2].sigma_a[c], push.g);
  single_flux[i] = vec4(sum, 0);
}

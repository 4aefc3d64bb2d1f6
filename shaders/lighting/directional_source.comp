// The directional boundary source (shared/optics.h) of the two sides of each cut cell: for every light sample the share that
// enters the boundary condition and the share that leaves at once, by its refracted cosine and the medium there.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"
#include "shared/lighting.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { EntryPush push; };
#include "lighting/arrivals.glsl"
layout(binding = 3, scalar) readonly buffer Receivers { Receiver receivers[]; };  // two a cut cell
layout(binding = 4, scalar) readonly buffer Media { FacetMedium media[]; };       // one a cut cell
layout(binding = 5, scalar) writeonly buffer GammaS { vec3 gamma_s[]; };          // Gamma_f, W/m^2
layout(binding = 6, scalar) writeonly buffer QueryGamma { vec3 query_gamma[]; };  // Gamma_f - A Gamma_c
layout(binding = 7, scalar) writeonly buffer Entered { vec3 entered[]; };         // W/m^2

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.receivers) return;
  const Receiver receiver = receivers[i];
  const vec3 absorbed = clamp(3 * media[i / 2].kappa * media[i / 2].sigma_a, 0, 1);
  const Sky sky = sky_over(i, receiver, push.eta, push.f_dt_outer);
  vec3 all = vec3(0), boundary = vec3(0), leaving = vec3(0);
  for (uint s = 0; s < arrivals(); ++s) {
    const Arrival light = arrival(s, receiver, push.eta, sky);
    if (light.cosine <= 0) continue;
    const float mu = refracted_cosine(light.cosine, push.eta);
    all += light.flux;
    for (int c = 0; c < 3; ++c) {
      boundary[c] += light.flux[c] * directional_boundary(mu, absorbed[c], push.A, push.f_dt);
      leaving[c] += light.flux[c] * directional_exit(mu, absorbed[c], push.A, push.f_dt);
    }
  }
  gamma_s[i] = boundary;
  query_gamma[i] = boundary - push.A * leaving;
  entered[i] = all;
}

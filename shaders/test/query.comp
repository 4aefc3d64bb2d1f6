// The shared optics on the device, one row of numbers a thread: eta, cosine, phi, gamma_s in; F_t, bracket, radiance out.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/optics.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { uint count; };
layout(binding = 0, scalar) readonly buffer Given { vec4 given[]; };
layout(binding = 1, scalar) readonly buffer Surface { vec4 constants[]; };  // A, F_dt, exit scale
layout(binding = 2, scalar) writeonly buffer Result { vec3 result[]; };
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= count) return;
  const vec4 g = given[i];
  const float f_t = fresnel_transmittance(g.y, g.x);
  const float bracket = query_bracket(g.z, g.w, constants[i].x, constants[i].y);
  result[i] = vec3(f_t, bracket, query_radiance(bracket, f_t, constants[i].z));
}

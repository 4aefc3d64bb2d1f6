// Every function of shared/optics.h on a list of inputs, for the test against their double-precision selves.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/optics.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { uint count; } push;
struct Values {
  float fresnel, diffuse, reduced, conductance, surface, bracket, radiance;
};
layout(binding = 0, scalar) readonly buffer Inputs { vec4 inputs[]; };  // mu, eta, x, y
layout(binding = 1, scalar) writeonly buffer Outputs { Values outputs[]; };
void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  vec4 v = inputs[i];
  float f_dr = internal_diffuse_reflectance(v.y);
  float A = boundary_constant(f_dr);
  float bracket = query_bracket(v.z, v.w, A, 1.0 - f_dr);
  outputs[i] = Values(fresnel_reflectance(v.x, v.y), f_dr, reduced_intensity(v.z, v.w), dsbc_conductance(A, v.z),
                      dsbc_surface_fluence(v.z, v.w, A, v.x), bracket, query_radiance(bracket, 1.0 - f_dr, 1.0 / (v.y * v.y)));
}

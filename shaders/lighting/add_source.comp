// The transport's own source of each entry and the boundary source of light from surfaces, together: all three of it.
//   gamma = gamma_own + gamma_surfaces, query likewise (the report's query subtracts its Gamma_s), entered = ... + flux.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { uint entries; };
layout(binding = 0, scalar) readonly buffer OwnGamma { vec3 own_gamma[]; };  // all W/m^2, two a cut cell
layout(binding = 1, scalar) readonly buffer OwnQuery { vec3 own_query[]; };
layout(binding = 2, scalar) readonly buffer OwnEntered { vec3 own_entered[]; };
layout(binding = 3, scalar) readonly buffer SurfacesGamma { vec3 surfaces_gamma[]; };
layout(binding = 4, scalar) readonly buffer SurfacesFlux { vec3 surfaces_flux[]; };
layout(binding = 5, scalar) writeonly buffer GammaS { vec3 gamma_s[]; };
layout(binding = 6, scalar) writeonly buffer QueryGamma { vec3 query_gamma[]; };
layout(binding = 7, scalar) writeonly buffer Entered { vec3 entered[]; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= entries) return;
  gamma_s[i] = own_gamma[i] + surfaces_gamma[i];
  query_gamma[i] = own_query[i] + surfaces_gamma[i];
  entered[i] = own_entered[i] + surfaces_flux[i];
}

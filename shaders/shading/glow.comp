// What the surface of one translucent object would send out if it let everything through: the render query (Eq. 14)
// without its Fresnel factor, W/m^2/sr, over the object's grid, its two sides one behind the other. For rays that meet
// any object: all lie in one image. Negative brackets are kept, so that trilinear sampling is that of the query.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/optics.h"
#include "shared/reflection.h"
layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant, scalar) uniform Push { GlowPush push; };
layout(binding = 0) uniform sampler3D phi_up;
layout(binding = 1) uniform sampler3D phi_down;
layout(binding = 2) uniform sampler3D gamma_up;
layout(binding = 3) uniform sampler3D gamma_down;
layout(binding = 4, rgba16f) uniform writeonly image3D glow;

vec4 query(vec3 phi, vec3 gamma) {
  vec4 radiance = vec4(0);
  for (int c = 0; c < 3; ++c)
    radiance[c] = query_radiance(query_bracket(phi[c], gamma[c], push.A, push.f_dt), 1, push.exit_scale);
  return radiance;
}

void main() {
  const ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, push.cells))) return;
  const ivec3 up = cell + ivec3(0, 0, push.z), down = up + ivec3(0, 0, push.cells.z);
  imageStore(glow, up, query(texelFetch(phi_up, cell, 0).rgb, texelFetch(gamma_up, cell, 0).rgb));
  imageStore(glow, down, query(texelFetch(phi_down, cell, 0).rgb, texelFetch(gamma_down, cell, 0).rgb));
}

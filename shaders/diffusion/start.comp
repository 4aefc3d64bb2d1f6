// r = b - A x, r . r, and the first smoothing step of a cycle: z = omega D^-1 r.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/apply.glsl"
#include "diffusion/partial.glsl"
layout(binding = 4, rgba32f) uniform readonly image3D inverse_l1;
layout(binding = 5, rgba32f) uniform readonly image3D b;
layout(binding = 6, rgba32f) uniform writeonly image3D r;
layout(binding = 7, rgba32f) uniform writeonly image3D z;

void main() {
  ivec3 t = texel_here();
  vec4 residual = imageLoad(b, t) - apply_finest(t);
  imageStore(r, t, residual);
  imageStore(z, t, push.omega * imageLoad(inverse_l1, t) * residual);
  leave_partial(dot(residual, residual));
}

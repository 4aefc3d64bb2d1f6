// One step of the Chebyshev smoother: smoothed = x + omega D^-1 (b - A x), D the l1 norm of the rows. On the finest
// level with `leave_dot` also b . smoothed, which the conjugate gradients need of the last step.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/packed.glsl"
#include "diffusion/partial.glsl"
layout(constant_id = 1) const int leave_dot = 0;
layout(binding = 5, rgba32f) uniform readonly image3D b;
layout(binding = 6, rgba32f) uniform writeonly image3D smoothed;

void main() {
  ivec3 t = texel_here();
  vec4 rhs = imageLoad(b, t);
  Applied a = apply_in_cycle(t);
  vec4 value = a.centre + push.omega * a.inverse_l1 * (rhs - a.product);
  imageStore(smoothed, t, value);
  if (leave_dot != 0) leave_partial(dot(rhs, value));
}

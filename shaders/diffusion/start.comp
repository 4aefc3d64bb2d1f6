// r = b - A (x + rest) and the first smoothing step of a cycle: z = omega D^-1 r. What x and rest have is subtracted
// apart: their sum has not the digits (update.comp). Three sums: r . r, |D^-1 r|^2 and x . x.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/apply.glsl"
#include "diffusion/partial.glsl"
layout(binding = 4, rgba32f) uniform readonly image3D inverse_l1;
layout(binding = 5, rgba32f) uniform readonly image3D b;
layout(binding = 6, rgba32f) uniform writeonly image3D r;
layout(binding = 7, rgba32f) uniform writeonly image3D z;
layout(binding = 8, rgba32f) uniform readonly image3D rest;

Star star_of_rest(ivec3 t) {
  vec4 own = imageLoad(rest, t);
  return Star(own, shifted_left(imageLoad(rest, t - step_x), own), shifted_right(own, imageLoad(rest, t + step_x)),
              imageLoad(rest, t - step_y), imageLoad(rest, t + step_y), imageLoad(rest, t - step_z),
              imageLoad(rest, t + step_z));
}

void main() {
  ivec3 t = texel_here();
  vec4 left = imageLoad(b, t) - apply_to(star_of_rest(t), t);
  vec4 residual = left - apply_finest(t), scaled = imageLoad(inverse_l1, t) * residual, own = imageLoad(x, t);
  imageStore(r, t, residual);
  imageStore(z, t, push.omega * scaled);
  leave_partial(0, dot(residual, residual));
  leave_partial(1, dot(scaled, scaled));
  leave_partial(2, dot(own, own));
}

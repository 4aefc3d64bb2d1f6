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

float step_to(ivec3 t, Applied a) {
  vec4 rhs = imageLoad(b, t), value = a.centre + push.omega * a.inverse_l1 * (rhs - a.product);
  imageStore(smoothed, t, value);
  return leave_dot != 0 ? dot(rhs, value) : 0;
}

void main() {
  if (finest == 0) {
    ivec3 t = texel_here();
    step_to(t, apply_on_coarse(t));
  } else {
    Column column = column_here();
    ivec3 t = column.texel;
    Layers z = Layers(imageLoad(x, t - step_z), imageLoad(x, t), vec4(0));
    float sum = 0;
    for (int k = 0; k < column.layers; ++k, ++t.z) {
      z.above = imageLoad(x, t + step_z);
      sum += step_to(t, apply_packed(t, z));
      z = Layers(z.own, z.above, vec4(0));
    }
    if (leave_dot != 0) leave_partial(sum);
  }
}

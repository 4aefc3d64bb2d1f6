// x += alpha p, r -= alpha q, r . r, and the first smoothing step of the next cycle: z = omega D^-1 r.
// x is kept as high + low: in one float its rounding alone would leave a residual above 1e-6 of |b| at 128^3.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/partial.glsl"
layout(binding = 2, scalar) readonly buffer Scalars { CgScalars scalars[]; };
layout(binding = 4, rgba32f) uniform readonly image3D inverse_l1;
layout(binding = 5, rgba32f) uniform readonly image3D p;
layout(binding = 6, rgba32f) uniform readonly image3D q;
layout(binding = 7, rgba32f) uniform image3D high;
layout(binding = 8, rgba32f) uniform image3D low;
layout(binding = 9, rgba32f) uniform image3D r;
layout(binding = 10, rgba32f) uniform writeonly image3D z;

void main() {
  ivec3 t = texel_here();
  float alpha = scalars[channel_here()].alpha;
  vec4 old = imageLoad(high, t);
  precise vec4 rest = imageLoad(low, t) + alpha * imageLoad(p, t);
  precise vec4 sum = old + rest;
  precise vec4 lost = rest - (sum - old);
  imageStore(high, t, sum);
  imageStore(low, t, lost);
  vec4 residual = imageLoad(r, t) - alpha * imageLoad(q, t);
  imageStore(r, t, residual);
  imageStore(z, t, push.omega * imageLoad(inverse_l1, t) * residual);
  leave_partial(dot(residual, residual));
}

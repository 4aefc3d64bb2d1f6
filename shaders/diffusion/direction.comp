// p = z + beta p; with `deflated` p = z + Z c + beta p, c from islands.comp
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/lift.glsl"
layout(constant_id = 1) const int deflated = 0;
layout(binding = 2, scalar) readonly buffer Scalars { CgScalars scalars[]; };
layout(binding = 5, rgba32f) uniform readonly image3D z;
layout(binding = 6, rgba32f) uniform image3D p;

void main() {
  ivec3 t = texel_here();
  vec4 direction = imageLoad(z, t);
  if (deflated != 0) direction += lift_at(t);
  imageStore(p, t, direction + scalars[channel_here()].beta * imageLoad(p, t));
}

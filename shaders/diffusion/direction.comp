// p = z + beta p
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
layout(binding = 2, scalar) readonly buffer Scalars { CgScalars scalars[]; };
layout(binding = 5, rgba32f) uniform readonly image3D z;
layout(binding = 6, rgba32f) uniform image3D p;

void main() {
  ivec3 t = texel_here();
  imageStore(p, t, imageLoad(z, t) + scalars[channel_here()].beta * imageLoad(p, t));
}

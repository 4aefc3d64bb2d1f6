// blended = step x + c0 v0 + c1 v1 + c2 v2 + c3 v3: of solutions of before.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
layout(binding = 1, rgba32f) uniform readonly image3D x;
layout(binding = 2, scalar) readonly buffer Coefficients { vec4 coefficients[]; };  // of each channel
layout(binding = 3, rgba32f) uniform readonly image3D v0;
layout(binding = 4, rgba32f) uniform readonly image3D v1;
layout(binding = 5, rgba32f) uniform readonly image3D v2;
layout(binding = 6, rgba32f) uniform readonly image3D v3;
layout(binding = 7, rgba32f) uniform writeonly image3D blended;

void main() {
  ivec3 t = texel_here();
  vec4 c = coefficients[channel_here()];
  vec4 sum = c.x * imageLoad(v0, t) + c.y * imageLoad(v1, t) + c.z * imageLoad(v2, t) + c.w * imageLoad(v3, t);
  imageStore(blended, t, push.step * imageLoad(x, t) + sum);
}

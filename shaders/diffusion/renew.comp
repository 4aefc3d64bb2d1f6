// Between two visits of a level: kept = step x, b -= A kept, and the first smoothing step of what is left,
// smoothed = omega D^-1 b.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/apply.glsl"
layout(binding = 4, rgba32f) uniform readonly image3D inverse_l1;
layout(binding = 5, rgba32f) uniform image3D b;
layout(binding = 6, rgba32f) uniform writeonly image3D smoothed;
layout(binding = 7, rgba32f) uniform writeonly image3D kept;

void main() {
  ivec3 t = texel_here();
  vec4 left = imageLoad(b, t) - push.step * apply(t);
  imageStore(kept, t, push.step * imageLoad(x, t));
  imageStore(b, t, left);
  imageStore(smoothed, t, push.omega * imageLoad(inverse_l1, t) * left);
}

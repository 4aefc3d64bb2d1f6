// Between two visits of a level: kept = step x, b -= A kept, and the first smoothing step of what is left,
// smoothed = omega D^-1 b.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/packed.glsl"
layout(binding = 5, rgba32f) uniform image3D b;
layout(binding = 6, rgba32f) uniform writeonly image3D smoothed;
layout(binding = 7, rgba32f) uniform writeonly image3D kept;

void main() {
  ivec3 t = texel_here();
  Applied a = apply_on_coarse(t);
  vec4 left = imageLoad(b, t) - push.step * a.product;
  imageStore(kept, t, push.step * a.centre);
  imageStore(b, t, left);
  imageStore(smoothed, t, push.omega * a.inverse_l1 * left);
}

// b = P^T residual, and the first smoothing step there from zero: x = omega D^-1 b.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/transfer.glsl"
layout(binding = 2, rgba32f) uniform readonly image3D residual;
layout(binding = 4, rgba32f) uniform readonly image3D inverse_l1;  // of the coarse level
layout(binding = 5, rgba32f) uniform writeonly image3D b;
layout(binding = 6, rgba32f) uniform writeonly image3D x;

void main() {
  ivec3 t = texel_of(push.coarse_cells.z);
  int channel = channel_here();
  ivec3 base = ivec3(2 * t.xy, 2 * (t.z - channel * push.coarse_cells.z) + channel * push.cells.z);
  vec4 sum = vec4(0);
  for (int row = 0; row < 9; ++row) {
    ivec3 s = base + ivec3(0, row % 3 - 1, row / 3 - 1);
    vec4 before = imageLoad(residual, s - step_x), low = imageLoad(residual, s), high = imageLoad(residual, s + step_x);
    sum += weight(3 * row, t) * vec4(before.w, low.yw, high.y);
    sum += weight(3 * row + 1, t) * vec4(low.xz, high.xz);
    sum += weight(3 * row + 2, t) * vec4(low.yw, high.yw);
  }
  imageStore(b, t, sum);
  imageStore(x, t, push.omega * imageLoad(inverse_l1, t) * sum);
}

// The coarse operator P^T A P, one entry k of one coarse cell an invocation; workgroup z = slice * 14 + k. The sums of
// its rows are made apart (deficits.comp) and taken over.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/setup.glsl"
layout(binding = 6, rgba32f) uniform writeonly image3D coarse_stencil;
layout(binding = 7, rgba32f) uniform readonly image3D weights;
layout(binding = 8, rgba32f) uniform readonly image3D row_sums;  // of the coarse operator
shared float results[group_cells];

float weight(int k, ivec3 coarse_cell) {
  return imageLoad(weights, ivec3(k * texels(push.coarse_cells.x) + (coarse_cell.x >> 2), coarse_cell.yz))[coarse_cell.x & 3];
}

// The share of all couplings i -> i + e: sum over fine cells i = 2 I + d of P(i, I) A(i, i + e) P(i + e, I + D).
float share(ivec3 e, ivec3 D, ivec3 coarse, ivec3 other, ivec3 base, bool active_, bool own) {
  ivec3 low = max(ivec3(-1), 2 * D - 1 - e), high = active_ ? min(ivec3(1), 2 * D + 1 - e) : ivec3(-2);
  float sum = 0;
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        ivec3 d = ivec3(x, y, z);
        float a = own ? fine_diagonal(base + d) : coupling(base + d, e);
        sum += weight(entry(d), coarse) * a * weight(entry(d + e - 2 * D), other);
      }
  return sum;
}

void main() {
  int k = int(gl_WorkGroupID.z) % DIFFUSION_COARSE_ENTRIES, slice = int(gl_WorkGroupID.z) / DIFFUSION_COARSE_ENTRIES;
  int channel = slice / push.coarse_cells.z;
  ivec3 I = ivec3(gl_GlobalInvocationID.xy, slice - channel * push.coarse_cells.z), D = offset(k);
  ivec3 coarse = ivec3(I.xy, slice), other = coarse + D, base = 2 * I + ivec3(0, 0, channel * push.cells.z);
  float any_weight = 0;
  for (int m = 0; m < DIFFUSION_WEIGHTS; ++m) any_weight += abs(weight(m, coarse));
  bool active_ = k != DIFFUSION_ROW_SUM && any_weight > 0 && in_grid(I, push.coarse_cells) && in_grid(I + D, push.coarse_cells);
  float sum = share(ivec3(0), D, coarse, other, base, active_, true);
  for (int n = 0; n < (finest != 0 ? 6 : 26); ++n) {
    ivec3 e = offset(n < 13 ? n : n + 1);
    if (finest != 0) {
      e = ivec3(0);
      e[n >> 1] = 2 * (n & 1) - 1;
    }
    sum += share(e, D, coarse, other, base, active_, false);
  }
  results[gl_LocalInvocationIndex] = sum;
  barrier();
  int nx4 = texels(push.coarse_cells.x);
  uint l = gl_LocalInvocationIndex;
  ivec3 texel = ivec3(gl_WorkGroupID.x * 4 + (l & 3), gl_WorkGroupID.y * 4 + (l >> 2 & 3), slice);
  if (l >= 16 || texel.x >= nx4) return;
  vec4 entries = vec4(results[4 * l], results[4 * l + 1], results[4 * l + 2], results[4 * l + 3]);
  imageStore(coarse_stencil, texel + ivec3(k * nx4, 0, 0), k == DIFFUSION_ROW_SUM ? imageLoad(row_sums, texel) : entries);
}

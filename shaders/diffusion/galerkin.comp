// The coarse operator P^T A P, one entry k of one coarse texel an invocation; workgroup z = slice * 14 + k.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/setup.glsl"
#include "diffusion/transfer.glsl"
layout(binding = 6, rgba32f) uniform writeonly image3D coarse_stencil;

vec4 weight_beside(int k, ivec3 t, int dx) {
  vec4 own = weight(k, t);
  return dx == 0 ? own : dx > 0 ? shifted_right(own, weight(k, t + step_x)) : shifted_left(weight(k, t - step_x), own);
}

void main() {
  int nx4 = texels(push.coarse_cells.x), k = int(gl_WorkGroupID.z) % DIFFUSION_COARSE_ENTRIES;
  ivec3 t = ivec3(gl_GlobalInvocationID.xy, gl_WorkGroupID.z / DIFFUSION_COARSE_ENTRIES);
  if (t.x >= nx4) return;
  int channel = t.z / push.coarse_cells.z;
  ivec3 base = fine_base(t, channel), D = offset(k), other = t + ivec3(0, D.yz);
  vec4 sum = vec4(0);
  int other_z = other.z - channel * push.coarse_cells.z;
  if (other_z >= 0 && other_z < push.coarse_cells.z)
    for (int m = 0; m < 27; ++m) {
      ivec3 d = offset(m);
      vec4 from = weight(m, t);
      for (int n = 0; n < 27; ++n) {
        ivec3 e = offset(n), j = d + e - 2 * D;
        if (max(abs(j.x), max(abs(j.y), abs(j.z))) > 1) continue;
        if (finest != 0 && abs(e.x) + abs(e.y) + abs(e.z) > 1) continue;
        vec4 to = weight_beside((j.x + 1) + 3 * (j.y + 1) + 9 * (j.z + 1), other, D.x);
        sum += from * coupling(base, d, e, channel) * to;
      }
    }
  ivec4 x = 4 * t.x + ivec4(0, 1, 2, 3) + D.x;
  imageStore(coarse_stencil, ivec3(k * nx4 + t.x, t.yz), mix(vec4(0), sum, lessThan(uvec4(x), uvec4(push.coarse_cells.x))));
}

// x += P correction. An invocation has a texel of four coarse cells I, and of the fine cells those from 2 I to 2 I + 1.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/transfer.glsl"
layout(binding = 2, rgba32f) uniform readonly image3D correction;  // coarse level
layout(binding = 6, rgba32f) uniform image3D x;

void main() {
  ivec3 coarse = texel_of(push.coarse_cells.z);
  int channel = channel_here(), z = 2 * (coarse.z - channel * push.coarse_cells.z);
  float has_next = float(coarse.x + 1 < texels(push.coarse_cells.x));
  for (int up_z = 0; up_z < min(2, push.cells.z - z); ++up_z)
    for (int up_y = 0; up_y < 2; ++up_y) {
      vec4 even = vec4(0), odd = vec4(0);  // at 2 I and 2 I + 1 along x
      for (int from_z = 0; from_z <= up_z; ++from_z)
        for (int from_y = 0; from_y <= up_y; ++from_y) {
          ivec3 s = coarse + ivec3(0, from_y, from_z);
          int row = 3 * (up_y - 2 * from_y + 1) + 9 * (up_z - 2 * from_z + 1);  // entry with x-offset -1
          vec4 own = imageLoad(correction, s);
          vec4 after = has_next * imageLoad(correction, s + step_x) * weight(row, s + step_x);
          even += own * weight(row + 1, s);
          odd += own * weight(row + 2, s) + shifted_right(own * weight(row, s), after);
        }
      ivec3 t = ivec3(2 * coarse.x, 2 * coarse.y + up_y, z + up_z + channel * push.cells.z);
      imageStore(x, t, imageLoad(x, t) + vec4(even.x, odd.x, even.y, odd.y));
      imageStore(x, t + step_x, imageLoad(x, t + step_x) + vec4(even.z, odd.z, even.w, odd.w));
    }
}

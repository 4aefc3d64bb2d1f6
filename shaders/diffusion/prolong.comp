// x += P correction
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/transfer.glsl"
layout(binding = 2, rgba32f) uniform readonly image3D correction;  // coarse level
layout(binding = 6, rgba32f) uniform image3D x;

void main() {
  ivec3 t = texel_here();
  int channel = channel_here(), z = t.z - channel * push.cells.z;
  bool upper_half = (t.x & 1) != 0;  // of the coarse texel that covers this one
  ivec2 odd = ivec2(t.y, z) & 1;
  ivec3 base = ivec3(t.x >> 1, t.y >> 1, (z >> 1) + channel * push.coarse_cells.z);
  vec4 sum = vec4(0);
  for (int up_z = 0; up_z <= odd.y; ++up_z)
    for (int up_y = 0; up_y <= odd.x; ++up_y) {
      ivec3 s = base + ivec3(0, up_y, up_z);
      int row = 3 * ((odd.x - 2 * up_y + 1) + 3 * (odd.y - 2 * up_z + 1));  // entry with x-offset -1
      vec4 from = imageLoad(correction, s), after = imageLoad(correction, s + step_x);
      vec4 same = from * weight(row + 1, s), to_right = from * weight(row + 2, s), to_left = from * weight(row, s);
      float next = upper_half ? after.x * weight(row, s + step_x).x : to_left.z;
      sum += upper_half ? vec4(same.z, to_right.z + to_left.w, same.w, to_right.w + next)
                        : vec4(same.x, to_right.x + to_left.y, same.y, to_right.y + next);
    }
  imageStore(x, t, imageLoad(x, t) + sum);
}

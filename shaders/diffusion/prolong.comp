// x += P correction. An invocation has a texel of four coarse cells I, and of the fine cells those from 2 I to 2 I + 1.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/transfer.glsl"
layout(binding = 2, rgba32f) uniform readonly image3D correction;  // coarse level
layout(binding = 6, rgba32f) uniform image3D x;

// What the fine cells at 2 I and 2 I + 1 along x take from the row of coarse cells at s.
struct Pair {
  vec4 even, odd;
};

// `row`: the entry with x-offset -1.
Pair taken(ivec3 s, int row, float has_next) {
  vec4 own = imageLoad(correction, s), after = has_next * imageLoad(correction, s + step_x) * weight(row, s + step_x);
  return Pair(own * weight(row + 1, s), own * weight(row + 2, s) + shifted_right(own * weight(row, s), after));
}

Pair sum(Pair a, Pair b) { return Pair(a.even + b.even, a.odd + b.odd); }

void add(ivec3 t, Pair p) {
  imageStore(x, t, imageLoad(x, t) + vec4(p.even.x, p.odd.x, p.even.y, p.odd.y));
  imageStore(x, t + step_x, imageLoad(x, t + step_x) + vec4(p.even.z, p.odd.z, p.even.w, p.odd.w));
}

// A row of fine cells takes from the coarse rows it lies between: written out, for a CPU's vector lanes.
void main() {
  ivec3 coarse = texel_of(push.coarse_cells.z);
  int channel = channel_here(), z = 2 * (coarse.z - channel * push.coarse_cells.z);
  float next = float(coarse.x + 1 < texels(push.coarse_cells.x));
  ivec3 up_y = coarse + step_y, up_z = coarse + step_z, up_yz = up_y + step_z;
  ivec3 t = ivec3(2 * coarse.x, 2 * coarse.y, z + channel * push.cells.z);
  add(t, taken(coarse, 12, next));
  add(t + step_y, sum(taken(coarse, 15, next), taken(up_y, 9, next)));
  if (z + 1 >= push.cells.z) return;
  add(t + step_z, sum(taken(coarse, 21, next), taken(up_z, 3, next)));
  add(t + step_y + step_z, sum(sum(taken(coarse, 24, next), taken(up_y, 18, next)),
                               sum(taken(up_z, 6, next), taken(up_yz, 0, next))));
}

// shared/procedural.h at a list of points, for the test against its double-precision self.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/procedural.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { uint count; ProceduralSolid solid; } push;
layout(binding = 0, scalar) readonly buffer Points { vec4 points[]; };  // units of the pattern; depth, m
layout(binding = 1, scalar) writeonly buffer Shares { vec2 shares[]; };
float share(uint part, vec4 p) {
  return solid_share(push.solid.kind, push.solid.seed, push.solid.turbulence, push.solid.sharpness, push.solid.depths.x,
                     push.solid.depths.y, part, p.x, p.y, p.z, p.w);
}
void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < push.count) shares[i] = vec2(share(1, points[i]), share(2, points[i]));
}

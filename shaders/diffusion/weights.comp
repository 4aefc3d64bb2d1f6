// Operator-dependent interpolation (Dendy 1982, black-box multigrid; three dimensions). A fine point with odd coordinates
// along some axes interpolates, by its own equation, from its neighbours with fewer odd coordinates within the span of
// those axes; along the other axes the stencil is collapsed, as if the solution were constant there. Points on no such
// neighbour (sheets and needles at odd index) stand for their own block: weight 1.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/setup.glsl"
layout(binding = 6, rgba32f) uniform writeonly image3D weights;

const float connected = 1e-7;  // of the diagonal: couplings below are none

void main() {
  ivec3 t = ivec3(gl_GlobalInvocationID);
  if (t.x >= texels(push.coarse_cells.x)) return;
  int channel = t.z / push.coarse_cells.z;
  ivec3 base = fine_base(t, channel);
  vec4 w[DIFFUSION_WEIGHTS];
  for (int odd = 0; odd <= 3; ++odd)
    for (int k = 0; k < DIFFUSION_WEIGHTS; ++k) {
      ivec3 d = offset(k), span = abs(d);
      if (span.x + span.y + span.z != odd) continue;
      vec4 own = diagonal_at(base, d, channel);
      vec4 centre = finest != 0 ? gather(DIFFUSION_REACTION, base, d, channel) : vec4(0), lower = vec4(0), here = vec4(0);
      for (int m = 0; m < 27; ++m) {
        ivec3 e = offset(m), within = e * span;
        if (finest != 0 && within != e) continue;  // couplings that the collapse cancels
        if (finest != 0 && abs(e.x) + abs(e.y) + abs(e.z) != 1) continue;
        vec4 c = coupling(base, d, e, channel);
        if (within == ivec3(0)) {
          centre += c;
          continue;
        }
        if (finest != 0) centre -= c;
        lower -= c;
        ivec3 from = d + within;
        if (abs(from.x) <= 1 && abs(from.y) <= 1 && abs(from.z) <= 1)
          here -= c * w[(from.x + 1) + 3 * (from.y + 1) + 9 * (from.z + 1)];
      }
      bool own_block = d.x >= 0 && d.y >= 0 && d.z >= 0;
      vec4 result;
      for (int lane = 0; lane < 4; ++lane) {
        bool orphan = lower[lane] <= connected * own[lane] || centre[lane] <= 0;
        result[lane] = own[lane] <= 0 ? 0 : orphan ? (own_block ? 1 : 0) : here[lane] / centre[lane];
      }
      w[k] = result;
      imageStore(weights, ivec3(k * texels(push.coarse_cells.x) + t.x, t.yz), result);
    }
}

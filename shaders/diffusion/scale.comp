// Chooses each channel's unit of fluence: the power of two above its largest boundary value. A power of two, so that a
// solution of before can be carried over without rounding.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"
#include "shared/optics.h"
layout(local_size_x = 256) in;
layout(push_constant, scalar) uniform PushBlock { SurfacePush push; };
layout(binding = 0, scalar) readonly buffer GammaS { vec3 gamma_s[]; };  // W/m^2, push.sides a cut cell
layout(binding = 1, scalar) buffer Scales { FluenceScale scales[]; };
shared float largest[256];

void main() {
  uint channel = gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
  float value = 0;
  for (uint i = uint(push.sides) + lane; i < uint(push.sides * push.count); i += 256) value = max(value, dsbc_source(gamma_s[i][channel], push.f_dt));
  largest[lane] = value;
  for (uint span = 128; span > 0; span >>= 1) {
    barrier();
    if (lane < span) largest[lane] = max(largest[lane], largest[lane + span]);
  }
  if (lane != 0) return;
  float before = scales[channel].unit;
  if (largest[0] > 0) {
    int exponent;
    frexp(largest[0], exponent);
    float unit = ldexp(1.0, exponent);
    scales[channel] = FluenceScale(unit, before / unit);
  } else {
    scales[channel] = FluenceScale(0, 0);
  }
}

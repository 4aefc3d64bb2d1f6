// The right-hand side b = B q / unit, q = 4 Gamma_s / F_dt, and the solution of before in the new unit.
#version 460
#extension GL_GOOGLE_include_directive : require
#define LEVEL_PUSH SurfacePush
#include "diffusion/level.glsl"
#include "diffusion/cut.glsl"
#include "shared/optics.h"
layout(binding = 3, scalar) readonly buffer Conductances { float conductances[]; };
layout(binding = 4, scalar) readonly buffer GammaS { vec3 gamma_s[]; };
layout(binding = 5, scalar) readonly buffer Scales { FluenceScale scales[]; };
layout(binding = 6, rgba32f) uniform writeonly image3D rhs;
layout(binding = 7, rgba32f) uniform image3D high;
layout(binding = 8, rgba32f) uniform image3D low;

void main() {
  ivec3 t = texel_here();
  int channel = channel_here();
  FluenceScale scale = scales[channel];
  ivec3 cell = ivec3(4 * t.x, t.y, t.z - channel * push.cells.z);
  vec4 b = vec4(0);
  for (int lane = 0; lane < 4; ++lane) {
    uint index = cut_at(cell + ivec3(lane, 0, 0));
    if (index == 0 || scale.unit == 0) continue;
    b[lane] = conductances[channel * push.count + index] * (dsbc_source(gamma_s[index][channel], push.f_dt) / scale.unit);
  }
  imageStore(rhs, t, b);
  imageStore(high, t, scale.ratio * imageLoad(high, t));
  imageStore(low, t, scale.ratio * imageLoad(low, t));
}

// The right-hand side of a source in the cells.
#version 460
#extension GL_GOOGLE_include_directive : require
#define LEVEL_PUSH SourcePush
#include "diffusion/level.glsl"
layout(binding = 5, scalar) readonly buffer Scales { FluenceScale scales[]; };
layout(binding = 6, rgba32f) uniform writeonly image3D rhs;
layout(binding = 7, rgba32f) uniform readonly image3D volume_power;  // W

void main() {
  ivec3 t = texel_here();
  int channel = channel_here();
  float unit = scales[channel].unit;
  imageStore(rhs, t, (unit > 0 ? push.per_power[channel] / unit : 0) * imageLoad(volume_power, t));
}

// phi of the cells within, brick by brick, and a first word on those near the surface, which surface.comp says anew.
#version 460
#extension GL_GOOGLE_include_directive : require
#define LEVEL_PUSH SurfacePush
#include "diffusion/level.glsl"
layout(constant_id = 1) const int channels = 3;
layout(binding = 3, scalar) readonly buffer Scales { FluenceScale scales[]; };
layout(binding = 6, rgba32f) uniform readonly image3D phi;
layout(binding = 9, rgba32f) uniform writeonly image3D phi_up;
layout(binding = 10, rgba32f) uniform writeonly image3D phi_down;

void main() {
  ivec3 t = texel_here();
  vec4 values[3];
  for (int c = 0; c < channels; ++c) values[c] = imageLoad(phi, t + ivec3(0, 0, c * push.cells.z)) * scales[c].unit;
  if (channels == 1) values[1] = values[2] = values[0];
  for (int lane = 0; lane < 4; ++lane) {
    ivec3 cell = ivec3(4 * t.x + lane, t.yz);
    vec4 value = vec4(values[0][lane], values[1][lane], values[2][lane], 1);
    imageStore(phi_up, cell, value);
    imageStore(phi_down, cell, value);
  }
}

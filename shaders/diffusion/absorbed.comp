// Partial sums of absorption * V * phi, in units of the solver.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/partial.glsl"
layout(binding = 4, rgba32f) uniform readonly image3D volume;
layout(binding = 5, rgba32f) uniform readonly image3D absorption;
layout(binding = 6, rgba32f) uniform readonly image3D phi;

void main() {
  ivec3 t = texel_here();
  leave_partial(dot(imageLoad(absorption, t) * imageLoad(volume, t - ivec3(0, 0, channel_here() * push.cells.z)), imageLoad(phi, t)));
}

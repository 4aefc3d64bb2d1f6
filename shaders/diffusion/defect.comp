// The residual within a cycle: defect = b - A x by the packed stencil.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/packed.glsl"
layout(binding = 5, rgba32f) uniform readonly image3D b;
layout(binding = 6, rgba32f) uniform writeonly image3D defect;

void main() {
  ivec3 t = texel_here();
  imageStore(defect, t, imageLoad(b, t) - apply_in_cycle(t).product);
}

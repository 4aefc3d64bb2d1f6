// By what factor at most the finest stencil's entries, in bf16, differ from those that are packed: one largest factor a
// subgroup. What is next to nothing beside the conductances counts as nothing.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/stencil.glsl"
#include "diffusion/bf16.glsl"
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
layout(binding = 3, scalar) writeonly buffer Factors { float factors[]; };
layout(binding = 8, rgba32ui) uniform readonly uimage3D pairs;

void main() {
  ivec3 t = texel_here();
  vec4 most = vec4(1), none = DIFFUSION_CONNECTED * (coefficient(0, t) + coefficient(1, t) + coefficient(2, t));
  for (int entry = 0; entry < DIFFUSION_FINEST_ENTRIES; ++entry) {
    vec4 now = uintBitsToFloat(rounded_bits(coefficient(entry, t)));
    vec4 then = uintBitsToFloat(imageLoad(pairs, ivec3(entry * texels(push.cells.x) + t.x, t.yz)) << 16);
    vec4 factor = max(now, then) / max(min(now, then), none);
    most = max(most, mix(factor, vec4(1), lessThanEqual(max(now, then), none)));
  }
  float worst = subgroupMax(max(max(most.x, most.y), max(most.z, most.w)));
  uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  if (subgroupElect()) factors[group * DIFFUSION_PARTIALS + gl_SubgroupID] = worst;
}

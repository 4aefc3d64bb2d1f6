// The dot products of b with the solutions of before, v0 to v3: partial sums, one a subgroup, in a fixed order.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
layout(binding = 1, rgba32f) uniform readonly image3D b;
layout(binding = 2, scalar) writeonly buffer Sums { vec4 sums[]; };  // zero where no subgroup comes
layout(binding = 3, rgba32f) uniform readonly image3D v0;
layout(binding = 4, rgba32f) uniform readonly image3D v1;
layout(binding = 5, rgba32f) uniform readonly image3D v2;
layout(binding = 6, rgba32f) uniform readonly image3D v3;

void main() {
  ivec3 t = texel_here();
  vec4 own = imageLoad(b, t);
  vec4 sum = subgroupAdd(vec4(dot(own, imageLoad(v0, t)), dot(own, imageLoad(v1, t)), dot(own, imageLoad(v2, t)),
                              dot(own, imageLoad(v3, t))));
  if (subgroupElect())
    sums[(gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * DIFFUSION_PARTIALS + gl_SubgroupID] = sum;
}

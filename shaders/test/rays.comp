// lighting/ray_tree.glsl on given rays.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "lighting/ray_tree.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { uint count; };
layout(binding = 2, scalar) readonly buffer Rays { vec3 rays[]; };  // origin, direction
layout(binding = 3, scalar) writeonly buffer Hits { RayHit hits[]; };
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i < count) hits[i] = trace_ray(rays[2 * i], rays[2 * i + 1], 0, 3e38);
}

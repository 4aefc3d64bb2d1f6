// What each side of each cut cell sees in each of its directions. One thread a ray, in the order of link_order.comp.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "lighting/ray_tree.glsl"
#include "lighting/link.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { LinkPush push; };
layout(binding = 2, scalar) readonly buffer Sides { ExchangeSide sides[]; };
layout(binding = 3, scalar) readonly buffer Receivers { Receiver receivers[]; };
layout(binding = 4, scalar) writeonly buffer Hits { RayHit hits[]; };  // [direction][side]
layout(binding = 5, scalar) writeonly buffer Links { uint links[]; };   // [direction][side]
layout(binding = 7, scalar) readonly buffer Order { uint order[]; };    // directions * side + direction
layout(binding = 6, scalar) buffer Counts { uint counts[]; };           // hits on each object, [object][share]

void main() {
  if (gl_GlobalInvocationID.x >= push.sides) return;
  const uint ray = order[gl_GlobalInvocationID.y * push.sides + gl_GlobalInvocationID.x], i = ray / push.directions, k = ray % push.directions;
  const Receiver r = receivers[sides[i].entry];
  const RayHit hit =
      trace_ray(link_origin(r), link_direction(r.normal, sides[i].entry, k, push.directions), 0, 3e38);
  hits[k * push.sides + i] = hit;
  links[k * push.sides + i] = hit.triangle == ray_missed ? link_open : link_dark;
  if (hit.triangle != ray_missed) atomicAdd(counts[ray_triangle(hit.triangle).object * push.shares + k % push.shares], 1);
}

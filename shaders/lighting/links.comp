// What each side of each cut cell sees in each of its directions. One thread a side and direction.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "lighting/tree.glsl"
#include "lighting/link.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { LinkPush push; };
layout(binding = 2, scalar) readonly buffer Sides { ExchangeSide sides[]; };
layout(binding = 3, scalar) readonly buffer Receivers { Receiver receivers[]; };
layout(binding = 4, scalar) writeonly buffer Hits { LinkHit hits[]; };  // [direction][side]
layout(binding = 5, scalar) writeonly buffer Links { uint links[]; };   // [direction][side]
layout(binding = 6, scalar) buffer Counts { uint counts[]; };           // hits on each object

void main() {
  const uint i = gl_GlobalInvocationID.x, k = gl_GlobalInvocationID.y;
  if (i >= push.sides) return;
  const Receiver r = receivers[sides[i].entry];
  const LinkHit hit =
      nearest_hit(link_origin(r), link_direction(r.normal, sides[i].entry, k, push.directions), push.tree);
  hits[k * push.sides + i] = hit;
  links[k * push.sides + i] = hit.triangle == tree_nothing ? link_open : link_dark;
  if (hit.triangle != tree_nothing) atomicAdd(counts[tree_triangles[hit.triangle].object & ~tree_closed], 1);
}

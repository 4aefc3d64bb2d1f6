// Links to one opaque object in the directions of one share of the lights: each place that was hit becomes an emitter, and
// a receiver of these. Their order may differ from run to run; what they hold does not depend on it.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "lighting/link.glsl"
#include "lighting/ray_tree.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { LinkPush push; };
layout(binding = 2, scalar) readonly buffer Sides { ExchangeSide sides[]; };
layout(binding = 3, scalar) readonly buffer Receivers { Receiver receivers[]; };
layout(binding = 4, scalar) readonly buffer Hits { RayHit hits[]; };
layout(binding = 5, scalar) buffer Links { uint links[]; };
layout(binding = 6, scalar) buffer Count { uint count; };  // emitters so far
layout(binding = 7, scalar) writeonly buffer Places { Receiver places[]; };
layout(binding = 8, scalar) writeonly buffer Transmitted { vec3 transmitted[]; };  // of emitters: albedo / pi for now

void main() {
  const uint i = gl_GlobalInvocationID.x, k = push.share + push.shares * gl_GlobalInvocationID.y;
  const uint at = k * push.sides + i;
  if (i >= push.sides || k >= push.directions || hits[at].triangle == ray_missed) return;
  const RayTriangle t = ray_triangle(hits[at].triangle);
  if (t.object != push.object) return;
  const uint entry = sides[i].entry;
  const Receiver r = receivers[entry];
  const vec3 way = link_direction(r.normal, entry, k, push.directions);
  const vec3 normal = normalize(cross(t.edge1, t.edge2));
  const uint slot = atomicAdd(count, 1);
  places[slot] = Receiver(link_origin(r) + hits[at].distance * way, dot(normal, way) > 0 ? -normal : normal, 0);
  transmitted[push.first + slot] = push.albedo * 0.3183098861837907;
  links[at] = push.first + slot;
}

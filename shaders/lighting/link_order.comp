// Puts the rays of links in order, so that those traced side by side go alike ways: first it counts the rays that go into each
// part of the sphere, then lists them part by part. Within a part their order may differ from run to run; no hit depends on it.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "lighting/link.glsl"
layout(local_size_x = 64) in;
layout(constant_id = 0) const int listing = 0;
layout(push_constant, scalar) uniform Push { LinkPush push; };
layout(binding = 2, scalar) readonly buffer Sides { ExchangeSide sides[]; };
layout(binding = 3, scalar) readonly buffer Receivers { Receiver receivers[]; };
layout(binding = 4, scalar) buffer Bins { uint bins[]; };           // how many rays, of each part; then how many are listed
layout(binding = 5, scalar) writeonly buffer Order { uint order[]; };  // directions * side + direction

// Nine on each face of a cube.
uint bin_of(vec3 way) {
  const vec3 size = abs(way);
  const uint axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const vec2 aside = (axis == 0 ? way.yz : axis == 1 ? way.zx : way.xy) / size[axis];
  const uvec2 part = uvec2(clamp(1.5 * aside + 1.5, 0, 2.999));
  return 9 * (2 * axis + (way[axis] < 0 ? 1 : 0)) + 3 * part.x + part.y;
}

void main() {
  if (gl_GlobalInvocationID.x >= push.sides) return;
  const uint ray = gl_GlobalInvocationID.y * push.sides + gl_GlobalInvocationID.x, i = ray / push.directions;
  const uint bin = bin_of(link_direction(receivers[sides[i].entry].normal, sides[i].entry, ray % push.directions, push.directions));
  if (listing == 0) {
    atomicAdd(bins[bin], 1);
    return;
  }
  uint before = 0;
  for (uint b = 0; b < bin; ++b) before += bins[b];
  order[before + atomicAdd(bins[link_bins + bin], 1)] = ray;
}

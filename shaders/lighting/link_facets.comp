// Links to one translucent object: from the place that was hit to the side of a cut cell that stands for it.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "domain/facet_class.glsl"
#include "lighting/link.glsl"
#include "lighting/ray_tree.glsl"
#include "shared/domain.h"
#include "shared/optics.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { LinkPush push; };
layout(binding = 2, scalar) readonly buffer Sides { ExchangeSide sides[]; };
layout(binding = 3, scalar) readonly buffer Receivers { Receiver receivers[]; };
layout(binding = 4, scalar) readonly buffer Hits { RayHit hits[]; };
layout(binding = 5, scalar) buffer Links { uint links[]; };
layout(binding = 6, r32ui) uniform readonly uimage3D cut_index;  // of what is hit
layout(binding = 7, scalar) readonly buffer CutCells { GpuCutCell cut_cells[]; };
layout(binding = 8, scalar) buffer Lost { uint lost; };

void main() {
  const uint i = gl_GlobalInvocationID.x, at = gl_GlobalInvocationID.y * push.sides + i;
  if (i >= push.sides || hits[at].triangle == ray_missed) return;
  const RayTriangle t = ray_triangle(hits[at].triangle);
  if (t.object != push.object) return;
  const uint entry = sides[i].entry;
  const Receiver r = receivers[entry];
  const vec3 way = link_direction(r.normal, entry, gl_GlobalInvocationID.y, push.directions);
  const vec3 normal = normalize(cross(t.edge1, t.edge2));
  const vec3 place = (link_origin(r) + hits[at].distance * way - push.origin) / push.h;
  const ivec3 cell = ivec3(floor(place));
  const int side = facet_class(normal) & 1;

  // The cell's own facet; where it has none on this side (it was given to a neighbour, or rounding moved the place) the
  // nearest around.
  uint found = 0;
  float least = 1e30;
  uint own = imageLoad(cut_index, cell).r;
  if (own != 0 && cut_cells[own].side[side].area > 0) found = own;
  for (int n = 0; n < (found != 0 ? 0 : 27); ++n) {
    const uint index = imageLoad(cut_index, cell + ivec3(n % 3, n / 3 % 3, n / 9) - 1).r;
    if (index == 0 || cut_cells[index].side[side].area <= 0) continue;
    const float far = distance(place, vec3(cut_cells[index].cell) + cut_cells[index].side[side].centre);
    if (far < least) {
      least = far;
      found = index;
    }
  }
  if (found == 0) {  // stays dark
    atomicAdd(lost, 1);
    return;
  }
  const float reflectance = fresnel_reflectance(-dot(way, normal), push.eta);
  links[at] = uint(round(255 * reflectance)) << 24 | (push.first + 2 * found + side);
}

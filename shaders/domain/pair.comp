// Lists the pairs of a triangle and a cell that it may meet, in any order: the sums made from them do not depend on it.
// One thread an item.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "sums.glsl"
#include "triangles.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { DomainPush push; };
layout(binding = 3, scalar) writeonly buffer Pairs { uvec2 pairs[]; };  // triangle, cell
layout(binding = 4, scalar) buffer Status { DomainStatus status; };

void main() {
  uint thread = gl_GlobalInvocationID.x;
  if (thread >= push.count) return;
  Item item = items[thread];
  Triangle t = load_triangle(item.triangle);
  uint end = min(item.first + cells_an_item, uint(t.size.x * t.size.y * t.size.z));
  uint met = 0u;
  for (uint n = item.first; n < end; ++n) met += plane_meets(t, box_cell(t, n)) ? 1u : 0u;
  uint at = atomicAdd(status.pairs_listed, met);
  for (uint n = item.first; n < end; ++n) {
    ivec3 cell = box_cell(t, n);
    if (plane_meets(t, cell)) pairs[at++] = uvec2(item.triangle, cell_index(cell, push.cells));
  }
}

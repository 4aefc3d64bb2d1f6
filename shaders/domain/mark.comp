// Marks every cell that a triangle may meet (bounding box and plane), and counts these pairs. One thread an item.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "sums.glsl"
#include "triangles.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { DomainPush push; };
layout(binding = 3, scalar) buffer Bits { uint bits[]; };
layout(binding = 4, scalar) buffer Status { DomainStatus status; };

void main() {
  uint thread = gl_GlobalInvocationID.x;
  if (thread >= push.count) return;
  Item item = items[thread];
  Triangle t = load_triangle(item.triangle);
  uint end = min(item.first + cells_an_item, uint(t.size.x * t.size.y * t.size.z));
  uint met = 0u;
  for (uint n = item.first; n < end; ++n) {
    ivec3 cell = box_cell(t, n);
    if (!plane_meets(t, cell)) continue;
    uint c = cell_index(cell, push.cells);
    atomicOr(bits[c >> 5], 1u << (c & 31u));
    ++met;
  }
  atomicAdd(status.pairs, met);
}

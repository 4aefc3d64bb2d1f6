// What the cut cells beside each whole cell of the rim (engine/diffusion/rim.h) send into it.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"
#include "diffusion/table.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform PushBlock { SourcePush push; };
layout(binding = 0, rgba32ui) uniform readonly uimage3D rim_cells;    // table: cut cells at -x +x -y +y; then at -z +z
layout(binding = 1, rgba32f) uniform readonly image3D face_fluxes;    // facets.comp; none of entry 0
layout(binding = 2, scalar) writeonly buffer CellSources { float cell_sources[]; };

void main() {
  uint cell = gl_GlobalInvocationID.x;
  int channel = int(gl_GlobalInvocationID.y), layer = 2 * channel;
  if (cell >= uint(push.rim_cells)) return;
  uvec4 beside = imageLoad(rim_cells, in_table(cell, 0)), along_z = imageLoad(rim_cells, in_table(cell, 1));
  float sent = imageLoad(face_fluxes, in_table(beside.x, layer)).y + imageLoad(face_fluxes, in_table(beside.y, layer)).x;
  sent += imageLoad(face_fluxes, in_table(beside.z, layer)).w + imageLoad(face_fluxes, in_table(beside.w, layer)).z;
  sent += imageLoad(face_fluxes, in_table(along_z.x, layer + 1)).y + imageLoad(face_fluxes, in_table(along_z.y, layer + 1)).x;
  cell_sources[(push.count + cell) * gl_NumWorkGroups.y + channel] = -sent;
}

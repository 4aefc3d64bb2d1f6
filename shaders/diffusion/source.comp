// The right-hand side where the surface makes it, on the texels of the rim (engine/diffusion/rim.h), from what facets.comp and rim.comp
// left; with `in_cells` on top of what power.comp put there.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"
#include "diffusion/table.glsl"
layout(local_size_x = 64) in;
layout(constant_id = 0) const int corrected = 0;
layout(constant_id = 1) const int in_cells = 0;
layout(push_constant, scalar) uniform PushBlock { SourcePush push; };
layout(binding = 0, rgba32ui) uniform readonly uimage3D rim_texels;  // table: the four cells' entries, 0 for none; then x, y, z
layout(binding = 1, scalar) readonly buffer CellSources { float cell_sources[]; };  // [cut cell, then the rim][channel]
layout(binding = 2, rgba32f) uniform image3D rhs;

void main() {
  uint texel = gl_GlobalInvocationID.x;
  int channel = int(gl_GlobalInvocationID.y);
  if (texel >= uint(push.rim_texels)) return;
  uvec4 entries = imageLoad(rim_texels, in_table(texel, 0));
  ivec3 t = ivec3(imageLoad(rim_texels, in_table(texel, 1)).xyz) + ivec3(0, 0, channel * push.cells.z);
  if (corrected == 0) entries *= uvec4(lessThan(entries, uvec4(push.count)));  // the rim gets nothing
  vec4 b = in_cells != 0 ? imageLoad(rhs, t) : vec4(0);
  for (int lane = 0; lane < 4; ++lane) b[lane] += cell_sources[entries[lane] * gl_NumWorkGroups.y + channel];
  imageStore(rhs, t, b);
}

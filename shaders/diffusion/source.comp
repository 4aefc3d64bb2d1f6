// The right-hand side from what facets.comp left for the cut cells and their faces, and from the source in the cells.
#version 460
#extension GL_GOOGLE_include_directive : require
#define LEVEL_PUSH SourcePush
#include "diffusion/level.glsl"
#include "diffusion/cut.glsl"
layout(constant_id = 1) const int corrected = 0;
layout(constant_id = 2) const int in_cells = 0;
layout(binding = 3, scalar) readonly buffer CellSources { float cell_sources[]; };  // [channel][cut cell]
layout(binding = 4, scalar) readonly buffer FaceFluxes { float face_fluxes[]; };    // [channel][cut cell][face]
layout(binding = 5, scalar) readonly buffer Scales { FluenceScale scales[]; };
layout(binding = 6, rgba32f) uniform writeonly image3D rhs;
layout(binding = 7, rgba32f) uniform readonly image3D volume_power;  // W

// What the cut cells around a whole cell send into it: entry 0 sends nothing.
float from_neighbours(ivec3 cell, int channel) {
  float sum = 0;
  for (int face = 0; face < 6; ++face) {
    ivec3 other = cell;
    other[face >> 1] += 2 * (face & 1) - 1;
    sum -= face_fluxes[(channel * push.count + cut_at(other)) * 6 + (face ^ 1)];
  }
  return sum;
}

void main() {
  ivec3 t = texel_here();
  int channel = channel_here();
  ivec3 cell = ivec3(4 * t.x, t.y, t.z - channel * push.cells.z);
  vec4 b = vec4(0);
  for (int lane = 0; lane < 4; ++lane) {
    ivec3 c = cell + ivec3(lane, 0, 0);
    uint index = cut_at(c);
    b[lane] = cell_sources[channel * push.count + index];
    if (corrected != 0 && index == 0) b[lane] = from_neighbours(c, channel);
  }
  float unit = scales[channel].unit;
  if (in_cells != 0 && unit > 0) b += (push.per_power[channel] / unit) * imageLoad(volume_power, t);
  imageStore(rhs, t, b);
}

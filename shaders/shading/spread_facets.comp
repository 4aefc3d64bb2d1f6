// Values of the facets' two sides as images to be sampled anywhere on the surface (trilinearly, one texel a cell): a cell's own
// facets, elsewhere the mean of those around; of the other side as far as that faces the same way (diffusion/surface.comp).
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/domain.h"
#include "shared/gather.h"
layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant, scalar) uniform Push { GatherPicturePush push; };
layout(binding = 0, scalar) readonly buffer Values { vec4 values[]; };  // two a cut cell
layout(binding = 1, r32ui) uniform readonly uimage3D cut_index;
layout(binding = 2, scalar) readonly buffer CutCells { GpuCutCell cut_cells[]; };
layout(binding = 3, rgba32f) uniform writeonly image3D up;
layout(binding = 4, rgba32f) uniform writeonly image3D down;

vec4 sums[2];
float areas[2];
vec3 normals[2];

void add(uint index) {
  for (int s = 0; s < 2; ++s) {
    const GpuFacet side = cut_cells[index].side[s];
    sums[s] += side.area * values[2 * index + s];
    areas[s] += side.area;
    normals[s] += side.area_vector;
  }
}

vec4 mean(int s) {
  const float sizes = max(length(normals[0]) * length(normals[1]), 1e-30);
  const float alike = areas[s] > 0 ? max(0, dot(normals[0], normals[1]) / sizes) : 1;
  const float area = areas[s] + alike * areas[1 - s];
  return area > 0 ? (sums[s] + alike * sums[1 - s]) / area : vec4(0);
}

void main() {
  const ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, push.cells))) return;
  for (int s = 0; s < 2; ++s) {
    sums[s] = vec4(0);
    areas[s] = 0;
    normals[s] = vec3(0);
  }
  const uint own = imageLoad(cut_index, cell).r;
  if (own != 0) add(own);
  for (int n = areas[0] + areas[1] > 0 ? 27 : 0; n < 27; ++n) {
    const uint index = imageLoad(cut_index, cell + ivec3(n % 3, n / 3 % 3, n / 9) - 1).r;
    for (uint there = min(index, 1); there > 0; --there) add(index);  // a CPU's lanes would run what stands in an `if`
  }
  imageStore(up, cell, mean(0));
  imageStore(down, cell, mean(1));
}

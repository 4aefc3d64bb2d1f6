// phi and the query's Gamma_s at the centres of the cells near the surface, to be sampled trilinearly anywhere on it; twice, for the
// two sides of a thin part (domain/facet_class.glsl), which may have their own light and their own phi within one cell. Where there
// is one side only, both images say the same.
// phi: inner cells as they are, cut cells carried from the centroid to the centre along their gradient, slivers and cells
// outside the mean of what the cut cells around them say (which may be negative: only on the surface is it a fluence). Gamma_s: a cut cell's own, else the mean of those around.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"
#include "diffusion/cut.glsl"
layout(local_size_x = 64) in;
layout(constant_id = 0) const int channels = 3;
layout(push_constant, scalar) uniform PushBlock { SurfacePush push; };
layout(binding = 3, scalar) readonly buffer Scales { FluenceScale scales[]; };
layout(binding = 5, rgba32f) uniform readonly image3D volume;
layout(binding = 6, rgba32f) uniform readonly image3D phi;
layout(binding = 9, rgba32f) uniform writeonly image3D phi_up;
layout(binding = 10, rgba32f) uniform writeonly image3D phi_down;
layout(binding = 11, rgba32f) uniform writeonly image3D gamma_up;
layout(binding = 12, rgba32f) uniform writeonly image3D gamma_down;
layout(binding = 13, scalar) readonly buffer NearCells { NearCell near_cells[]; };  // near_surface.h
layout(binding = 14, scalar) readonly buffer CutNeighbours { uint cut_neighbours[]; };
layout(binding = 15, rgba32f) uniform readonly image3D points;
layout(binding = 16, rgba32f) uniform readonly image3D lines;  // carry.comp
layout(binding = 17, rgba32f) uniform readonly image3D side_lights;

const float sliver = 0.05;  // h^3; a smaller cut cell's value comes from its neighbours, as if it were outside

// What cut cell `index` says of the point `away` from its low corner, h, to one side of its surface.
vec3 carried(uint index, vec3 away, int side) {
  vec3 result;
  for (int c = 0; c < channels; ++c) result[c] = dot(imageLoad(lines, in_table(index, 2 * c + side)), vec4(away, 1));
  return channels == 1 ? result.rrr : result;
}

struct Around {
  vec4 light[2];  // by side, area Gamma_s and area
  vec3 phi[2];
};

// Without `wants_phi` only the light. The loop over sides is empty then: a CPU's vector lanes would run a branch they do
// not take.
Around look_around(NearCell near, bool wants_phi) {
  Around around = Around(vec4[2](vec4(0), vec4(0)), vec3[2](vec3(0), vec3(0)));
  float weights = 0;
  for (uint i = near.begin; i < near.end; ++i) {
    uint neighbour = cut_neighbours[i], index = neighbour & 0x7ffffffu;
    int n = int(neighbour >> 27);
    for (int side = 0; side < 2; ++side) around.light[side] += imageLoad(side_lights, in_table(index, side));
    for (int side = wants_phi ? 0 : 2; side < 2; ++side) {
      vec4 point = imageLoad(points, in_table(index, 0));
      vec3 away = vec3(1.5) - vec3(n % 3, n / 3 % 3, n / 9), apart = away - point.xyz;
      float weight = point.w / dot(apart, apart);
      around.phi[side] += weight * carried(index, away, side);
      weights += 0.5 * weight;
    }
  }
  for (int side = 0; side < 2; ++side) around.phi[side] = weights > 0 ? around.phi[side] / weights : vec3(0);
  return around;
}

// The mean of a side, and of the other side as far as it faces the same way (`alike`, 0 to 1): on a smooth surface the parting of
// the sides leaves no seam, on a thin part it keeps the sheets apart.
vec3 mean_gamma(vec4 light[2], float alike, int side) {
  vec4 sum = light[side] + (light[side].w > 0 ? alike : 1) * light[1 - side];
  return sum.w > 0 ? sum.rgb / sum.w : vec3(0);
}

void main() {
  uint number = gl_GlobalInvocationID.x;
  if (number >= near_cells.length()) return;
  NearCell near = near_cells[number];
  ivec3 cell = ivec3(near.cell & 1023u, near.cell >> 10 & 1023u, near.cell >> 20);
  float own = imageLoad(volume, ivec3(cell.x >> 2, cell.yz))[cell.x & 3];
  uint index = cut_at(cell);
  bool whole = index == 0 && own > 0, cut = index != 0 && own >= sliver;
  Around around = look_around(near, !(whole || cut));
  vec4 here[2] = vec4[2](vec4(0), vec4(0));
  if (index != 0)
    here = vec4[2](imageLoad(side_lights, in_table(index, 0)), imageLoad(side_lights, in_table(index, 1)));
  vec3 inner;
  for (int c = 0; c < channels; ++c)
    inner[c] = imageLoad(phi, ivec3(cell.x >> 2, cell.y, cell.z + c * push.cells.z))[cell.x & 3] * scales[c].unit;
  if (channels == 1) inner = inner.rrr;
  vec3 value[2], gamma[2];
  for (int side = 0; side < 2; ++side) {
    value[side] = cut ? carried(index, vec3(0.5), side) : whole ? inner : around.phi[side];
    gamma[side] = here[side].w > 0 ? mean_gamma(here, near.alike_here, side) : mean_gamma(around.light, near.alike, side);
    if (channels == 1) gamma[side] = gamma[side].rrr;
  }
  imageStore(phi_up, cell, vec4(value[0], 1));
  imageStore(phi_down, cell, vec4(value[1], 1));
  imageStore(gamma_up, cell, vec4(gamma[0], 1));
  imageStore(gamma_down, cell, vec4(gamma[1], 1));
}

// phi and the query's Gamma_s at cell centres, to be sampled trilinearly anywhere on the surface; twice, for the two sides of a thin
// part (domain/facet_class.glsl), which may have their own light and their own phi within one cell. Where there is one side
// only, both images say the same.
// phi: inner cells as they are, cut cells carried from the centroid to the centre along their gradient, slivers and cells
// outside the mean of what the cut cells around them say (which may be negative: only on the surface is it a fluence). Gamma_s: a cut cell's own, else the mean of those around.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"
#include "diffusion/cut.glsl"
#include "shared/optics.h"
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const int near = 0;  // 0: texel by texel of the grid; 1: the cells of the list
layout(push_constant, scalar) uniform PushBlock { SurfacePush push; };
layout(binding = 3, scalar) readonly buffer Scales { FluenceScale scales[]; };
layout(binding = 4, scalar) readonly buffer Gradients { vec4 gradients[]; };
layout(binding = 5, rgba32f) uniform readonly image3D volume;
layout(binding = 6, rgba32f) uniform readonly image3D phi;
#include "diffusion/light.glsl"
layout(binding = 15, scalar) readonly buffer QueryGamma { vec3 query_gamma[]; };  // as gamma_s
layout(binding = 9, rgba32f) uniform writeonly image3D phi_up;
layout(binding = 10, rgba32f) uniform writeonly image3D phi_down;
layout(binding = 11, rgba32f) uniform writeonly image3D gamma_up;
layout(binding = 12, rgba32f) uniform writeonly image3D gamma_down;

layout(binding = 16, scalar) readonly buffer NearCells { uint near_cells[]; };  // x | y << 10 | z << 20: near_surface.h

const float sliver = 0.05;  // h^3; a smaller cut cell's value comes from its neighbours, as if it were outside

// What cut cell `index` says of the point `away` from its low corner, h, to one side of its surface. Where two sheets lie back
// to back the cell's gradient says nothing across them: there each side has the slope between the cell's value and the
// fluence on its own sheet, by the series resistance (dsbc_surface_fluence).
vec3 carried(uint index, vec3 away, int side) {
  GpuFacet facet = cut_cells[index].side[side];
  bool own_slope = bent(cut_cells[index].facet) && facet.area > 0;
  float depth = max(facet.distance, least_distance);
  vec3 r = away - cut_cells[index].centre, normal = own_slope ? normalize(facet.area_vector) : vec3(0), result;
  float across = dot(normal, r);
  for (int c = 0; c < 3; ++c) {
    int channel = min(c, push.channels - 1);
    vec4 g = gradients[channel * push.count + index];
    float q = dsbc_source(gamma_of(index, side)[channel], push.f_dt);
    float sheet = dsbc_surface_fluence(g.w, q, push.A, depth * push.h / facets[index].kappa[channel]);
    result[c] = g.w + dot(g.xyz, r - across * normal) + across * (sheet - g.w) / depth;
  }
  return result;
}

// Sums over facets of one side: area times Gamma_s with the area, and the area vector.
struct SideSums {
  vec4 gamma;
  vec3 normal;
};

void add(inout SideSums sums[2], uint index) {
  for (int side = 0; side < 2; ++side) {
    GpuFacet facet = cut_cells[index].side[side];
    sums[side].gamma += facet.area * vec4(query_gamma[push.sides == 2 ? 2 * index + side : index], 1);
    sums[side].normal += facet.area_vector;
  }
}

struct Around {
  SideSums sums[2];
  vec3 phi[2];
};

// Without `wants_phi` only the light. The loop over sides is empty then: a CPU's vector lanes would run a branch they do
// not take.
Around look_around(ivec3 cell, bool wants_phi) {
  Around around;
  float weights = 0;
  for (int side = 0; side < 2; ++side) {
    around.sums[side] = SideSums(vec4(0), vec3(0));
    around.phi[side] = vec3(0);
  }
  for (int n = 0; n < 27; ++n) {
    ivec3 d = ivec3(n % 3, n / 3 % 3, n / 9) - 1;
    uint index = cut_at(cell + d);
    if (index == 0) continue;
    vec3 away = vec3(0.5) - vec3(d), apart = away - cut_cells[index].centre;
    float weight = cut_cells[index].volume / dot(apart, apart);
    for (int side = wants_phi ? 0 : 2; side < 2; ++side) around.phi[side] += weight * carried(index, away, side);
    weights += weight;
    add(around.sums, index);
  }
  for (int side = 0; side < 2; ++side) around.phi[side] = weights > 0 ? around.phi[side] / weights : vec3(0);
  return around;
}

// The mean of a side, and of the other side as far as it faces the same way: on a smooth surface the parting of the sides
// leaves no seam, on a thin part it keeps the sheets apart.
vec3 mean_gamma(SideSums sums[2], int side) {
  float alike = max(0, dot(sums[0].normal, sums[1].normal) / max(length(sums[0].normal) * length(sums[1].normal), 1e-30));
  vec4 sum = sums[side].gamma + (sums[side].gamma.w > 0 ? alike : 1) * sums[1 - side].gamma;
  return sum.w > 0 ? sum.rgb / sum.w : vec3(0);
}

// phi of cells far from any surface, and a first word on the others, which the second dispatch says anew. Their Gamma_s
// stays as the images were made: zero.
void far_cells(ivec3 t) {
  vec4 own = imageLoad(volume, t), values[3];
  for (int c = 0; c < 3; ++c) {
    int channel = min(c, push.channels - 1);
    values[c] = imageLoad(phi, t + ivec3(0, 0, channel * push.cells.z)) * scales[channel].unit;
  }
  for (int lane = 0; lane < 4; ++lane) {
    ivec3 cell = ivec3(4 * t.x + lane, t.yz);
    float inside = float(cut_at(cell) == 0 && own[lane] > 0);
    vec4 value = vec4(inside * vec3(values[0][lane], values[1][lane], values[2][lane]), 1);
    imageStore(phi_up, cell, value);
    imageStore(phi_down, cell, value);
  }
}

void near_cell(uint number) {
  uint packed_cell = near_cells[min(number, near_cells.length() - 1)];
  ivec3 cell = ivec3(packed_cell & 1023u, packed_cell >> 10 & 1023u, packed_cell >> 20);
  float own = imageLoad(volume, ivec3(cell.x >> 2, cell.yz))[cell.x & 3];
  uint index = cut_at(cell);
  bool whole = index == 0 && own > 0, cut = index != 0 && own >= sliver;
  Around around = look_around(cell, !(whole || cut));
  SideSums here[2] = SideSums[2](SideSums(vec4(0), vec3(0)), SideSums(vec4(0), vec3(0)));
  if (index != 0) add(here, index);
  vec3 inner;
  for (int c = 0; c < 3; ++c) {
    int channel = min(c, push.channels - 1);
    inner[c] = imageLoad(phi, ivec3(cell.x >> 2, cell.y, cell.z + channel * push.cells.z))[cell.x & 3] * scales[channel].unit;
  }
  if (number >= near_cells.length()) return;
  for (int side = 0; side < 2; ++side) {
    vec3 value = whole ? inner : around.phi[side];
    if (cut) value = carried(index, vec3(0.5), side);
    vec3 gamma = here[side].gamma.w > 0 ? mean_gamma(here, side) : mean_gamma(around.sums, side);
    if (push.channels == 1) gamma = gamma.rrr;
    if (side == 0) {
      imageStore(phi_up, cell, vec4(value, 1));
      imageStore(gamma_up, cell, vec4(gamma, 1));
    } else {
      imageStore(phi_down, cell, vec4(value, 1));
      imageStore(gamma_down, cell, vec4(gamma, 1));
    }
  }
}

void main() {
  if (near == 0)
    far_cells(ivec3(gl_GlobalInvocationID));
  else
    near_cell(64 * gl_WorkGroupID.x + gl_LocalInvocationIndex);
}

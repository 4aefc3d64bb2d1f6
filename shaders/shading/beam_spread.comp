// Spreads the fluence of beams as SP3's second equation spreads what P1 lacks where light was just scattered (Klose and Larsen 2006,
// J. Comput. Phys. 220): sigma_t' T - div(9/35 / sigma_t' grad T) = sigma_t' phi_b, of which the surface takes `leak` T. One half of
// a sweep of successive over-relaxation, in place: cells of one colour from those of the other.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/domain.h"
#include "shared/gather.h"
layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant, scalar) uniform Push { GatherSpreadPush push; };
layout(binding = 0, scalar) uniform Grid { GatherGrid grid; };
layout(binding = 1, rgba32f) uniform readonly image3D volume;
layout(binding = 2, rgba32f) uniform readonly image3D kappa;
layout(binding = 3, r32ui) uniform readonly uimage3D cut_index;
layout(binding = 4, scalar) readonly buffer CutCells { GpuCutCell cut_cells[]; };
layout(binding = 5, rgba32f) uniform readonly image3D aperture_x;
layout(binding = 6, rgba32f) uniform readonly image3D aperture_y;
layout(binding = 7, rgba32f) uniform readonly image3D aperture_z;
layout(binding = 8, rgba32f) uniform readonly image3D beams;  // phi_b, one texel a cell
layout(binding = 9, rgba32f) uniform image3D spread;          // T, likewise

// Mean free path, h; 0 where there is no solid.
vec3 path_at(ivec3 c) {
  vec3 path = vec3(0);
  if (any(lessThan(c, ivec3(0))) || any(greaterThanEqual(c, grid.cells))) return path;
  for (int k = 0; k < grid.channels; ++k)
    path[k] = 3 * imageLoad(kappa, ivec3(c.x >> 2, c.y, c.z + k * grid.cells.z))[c.x & 3] * grid.kappa_scale[k] / grid.h;
  return path;
}

float aperture(int axis, ivec3 c) {
  const ivec3 t = ivec3(c.x >> 2, c.yz);
  const vec4 texel = axis == 0 ? imageLoad(aperture_x, t) : axis == 1 ? imageLoad(aperture_y, t) : imageLoad(aperture_z, t);
  return texel[c.x & 3];
}

void relax(ivec3 cell, float volume_here) {
  const vec3 path = path_at(cell), own = volume_here / max(path, vec3(1e-30));
  vec3 gains = own * imageLoad(beams, cell).rgb, loses = own;
  for (int n = 0; n < 6; ++n) {
    const int axis = n >> 1;
    ivec3 other = cell;
    other[axis] += 2 * (n & 1) - 1;
    const vec3 path_there = path_at(other);
    const float open = aperture(axis, min(max(cell, other), grid.cells - 1));  // beyond the grid path_there is 0
    const vec3 joined = open * GATHER_SPREAD * 2 * path * path_there / max(path + path_there, vec3(1e-30));
    for (int once = joined != vec3(0) ? 1 : 0; once > 0; --once) gains += joined * imageLoad(spread, other).rgb;
    loses += joined;
  }
  const uint index = imageLoad(cut_index, cell).r;
  if (index != 0) loses += push.leak * (cut_cells[index].side[0].area + cut_cells[index].side[1].area);
  const vec3 before = imageLoad(spread, cell).rgb;
  imageStore(spread, cell, vec4(before + push.relaxation * (gains / max(loses, vec3(1e-30)) - before), 1));
}

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  cell.x = 2 * cell.x + ((cell.y + cell.z + push.colour) & 1);
  if (any(greaterThanEqual(cell, grid.cells))) return;
  const float volume_here = imageLoad(volume, ivec3(cell.x >> 2, cell.yz))[cell.x & 3];
  for (int once = volume_here > 0 ? 1 : 0; once > 0; --once) relax(cell, volume_here);  // a CPU's lanes would run an `if`
}

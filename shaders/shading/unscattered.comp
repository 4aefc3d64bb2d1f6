// Of the light that beams bring near each cell, the share that no surface has sent: only that is scattered once where a view
// ray meets it. Under a tent of two cells, of what is scattered in the cells and in their facets' skin together.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/domain.h"
#include "shared/gather.h"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, scalar) uniform Grid { GatherGrid grid; };
layout(binding = 1, rgba32f) uniform readonly image3D power;      // W, packed
layout(binding = 2, rgba8) uniform readonly image3D power_share;  // of it, not sent by surfaces
layout(binding = 3, r32ui) uniform readonly uimage3D cut_index;
layout(binding = 4, scalar) readonly buffer CutCells { GpuCutCell cut_cells[]; };
layout(binding = 5, scalar) readonly buffer Near { vec4 near_light[]; };                 // W/m^2, two a cut cell
layout(binding = 6, scalar) readonly buffer NearUnscattered { vec4 near_unscattered[]; };  // of it, not sent by surfaces
layout(binding = 7, rgba8) uniform writeonly image3D share;  // one texel a cell
layout(binding = 8, rgba32f) uniform readonly image3D fluence;    // of beam_fluence.comp: dark where no power is near
layout(binding = 9, rgba32f) uniform readonly image3D near_up;    // of spread_facets.comp
layout(binding = 10, rgba32f) uniform readonly image3D near_down;

void main() {
  const ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, grid.cells))) return;
  vec3 all = vec3(0), own = vec3(0);  // W
  const bool dark = imageLoad(fluence, cell).rgb + imageLoad(near_up, cell).rgb + imageLoad(near_down, cell).rgb == vec3(0);
  for (int n = dark ? 27 : 0; n < 27; ++n) {
    const ivec3 d = ivec3(n % 3, n / 3 % 3, n / 9) - 1, c = cell + d;
    if (any(lessThan(c, ivec3(0))) || any(greaterThanEqual(c, grid.cells))) continue;
    const float weight = exp2(-float(abs(d.x) + abs(d.y) + abs(d.z)));
    for (int k = 0; k < grid.channels; ++k) {
      const ivec3 texel = ivec3(c.x >> 2, c.y, c.z + k * grid.cells.z);
      const float watts = weight * imageLoad(power, texel)[c.x & 3];
      all[k] += watts;
      own[k] += watts * imageLoad(power_share, texel)[c.x & 3];
    }
    const uint index = imageLoad(cut_index, c).r;
    for (uint s = index == 0 ? 2 : 0; s < 2; ++s) {  // a CPU's lanes would run what stands in an `if`
      const float area = weight * cut_cells[index].side[s].area * grid.h * grid.h;
      all += area * near_light[2 * index + s].rgb;
      own += area * near_unscattered[2 * index + s].rgb;
    }
  }
  if (grid.channels == 1) all = all.rrr, own = own.rrr;
  imageStore(share, cell, vec4(mix(vec3(1), own / max(all, vec3(1e-37)), greaterThan(all, vec3(0))), 1));
}

// Fluence of the beams in the cells, without and with what they scatter in the facets' skin: power and sigma_s' times volume each
// under a tent of two cells, so that the pattern of the beams does not show, and neither does what scatters more leak into what
// scatters less. Where the tent holds less than a cell of the object, which a beam meets by chance, as much of the cells around is
// taken in as makes it one.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/domain.h"
#include "shared/gather.h"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, scalar) uniform Grid { GatherGrid grid; };
layout(binding = 1, rgba32f) uniform readonly image3D volume;
layout(binding = 2, rgba32f) uniform readonly image3D power;  // W, packed
layout(binding = 3, rgba32f) uniform writeonly image3D fluence;  // W/m^2, one texel a cell
layout(binding = 4, rgba32f) uniform readonly image3D kappa;
layout(binding = 5, rgba32f) uniform readonly image3D absorption;
layout(binding = 6, scalar) readonly buffer CutCells { GpuCutCell cut_cells[]; };
layout(binding = 7, r32ui) uniform readonly uimage3D cut_index;
layout(binding = 8, scalar) readonly buffer Near { vec4 near_light[]; };  // W/m^2, two a cut cell
layout(binding = 9, rgba32f) uniform writeonly image3D shift;             // with the skin
layout(binding = 10, rgba32f) uniform writeonly image3D spread;           // the same
#define GRID grid
#include "domain/way.glsl"

void main() {
  const ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, grid.cells))) return;
  vec3 watts = vec3(0), watts_around = vec3(0), scatters = vec3(0), scatters_around = vec3(0);  // h^2
  vec3 skin = vec3(0), skin_around = vec3(0);  // W
  float size = 0, size_around = 0;
  for (int n = 0; n < 27; ++n) {
    const ivec3 d = ivec3(n % 3, n / 3 % 3, n / 9) - 1, c = cell + d;
    if (any(lessThan(c, ivec3(0))) || any(greaterThanEqual(c, grid.cells))) continue;
    const int away = abs(d.x) + abs(d.y) + abs(d.z);
    const float weight = away == 0 ? 1.0 : away == 1 ? 0.1 : 0.01, volume_there = imageLoad(volume, ivec3(c.x >> 2, c.yz))[c.x & 3];
    size += weight * volume_there;
    size_around += (1 - weight) * volume_there;
    const Solid solid = solid_at(c);
    scatters += weight * volume_there * solid.albedo * solid.sigma_t;
    scatters_around += (1 - weight) * volume_there * solid.albedo * solid.sigma_t;
    const uint index = imageLoad(cut_index, c).r;
    for (uint s = index == 0 ? 2 : 0; s < 2; ++s) {  // a CPU's lanes would run what stands in an `if`
      const vec3 near_there = cut_cells[index].side[s].area * grid.h * grid.h * near_light[2 * index + s].rgb;
      skin += weight * near_there;
      skin_around += (1 - weight) * near_there;
    }
    for (int k = 0; k < grid.channels; ++k) {
      const float power_there = imageLoad(power, ivec3(c.x >> 2, c.y, c.z + k * grid.cells.z))[c.x & 3];
      watts[k] += weight * power_there;
      watts_around[k] += (1 - weight) * power_there;
    }
  }
  const float wider = size_around > 0 ? clamp((1 - size) / size_around, 0, 1) : 0;
  watts += wider * watts_around;
  scatters += wider * scatters_around;
  skin += wider * skin_around;
  if (grid.channels == 1) watts = watts.rrr, scatters = scatters.rrr, skin = skin.rrr;
  scatters = max(scatters * grid.h * grid.h, vec3(1e-30));
  const vec4 all = vec4((watts + skin) / scatters, 1);
  imageStore(fluence, cell, vec4(watts / scatters, 1));
  imageStore(shift, cell, all);
  imageStore(spread, cell, all);
}

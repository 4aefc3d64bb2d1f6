// Power that beams scatter in the cells, per volume: power and volume each under a tent of two cells, so that the pattern of the
// beams does not show. Where that holds less than a cell of the object, which a beam meets by chance, as much of the cells around
// is taken in as makes it one.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/gather.h"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, scalar) uniform Grid { GatherGrid grid; };
layout(binding = 1, rgba32f) uniform readonly image3D volume;
layout(binding = 2, rgba32f) uniform readonly image3D power;  // W, packed
layout(binding = 3, rgba32f) uniform writeonly image3D density;  // W/m^3, one texel a cell

void main() {
  const ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, grid.cells))) return;
  vec3 watts = vec3(0), watts_around = vec3(0);
  float size = 0, size_around = 0;
  for (int n = 0; n < 27; ++n) {
    const ivec3 d = ivec3(n % 3, n / 3 % 3, n / 9) - 1, c = cell + d;
    if (any(lessThan(c, ivec3(0))) || any(greaterThanEqual(c, grid.cells))) continue;
    const int away = abs(d.x) + abs(d.y) + abs(d.z);
    const float weight = away == 0 ? 1.0 : away == 1 ? 0.1 : 0.01, volume_there = imageLoad(volume, ivec3(c.x >> 2, c.yz))[c.x & 3];
    size += weight * volume_there;
    size_around += (1 - weight) * volume_there;
    for (int k = 0; k < grid.channels; ++k) {
      const float power_there = imageLoad(power, ivec3(c.x >> 2, c.y, c.z + k * grid.cells.z))[c.x & 3];
      watts[k] += weight * power_there;
      watts_around[k] += (1 - weight) * power_there;
    }
  }
  const float wider = size_around > 0 ? clamp((1 - size) / size_around, 0, 1) : 0;
  watts += wider * watts_around;
  size += wider * size_around;
  if (grid.channels == 1) watts = watts.rrr;
  imageStore(density, cell, vec4(size > 0 ? watts / (size * grid.h * grid.h * grid.h) : vec3(0), 1));
}

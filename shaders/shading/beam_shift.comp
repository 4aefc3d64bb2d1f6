// By how much spreading moves the fluence of beams (beam_spread.comp): T / kept - phi_b, in phi_b's place. `kept` is what of it a
// half space would send, and there the closure says all: what stays is where other media or surfaces are near. Outside cells,
// which a sample on the surface reads too, take the mean T around.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/gather.h"
layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant, scalar) uniform Push { GatherShiftPush push; };
layout(binding = 0, rgba32f) uniform readonly image3D volume;
layout(binding = 1, rgba32f) uniform readonly image3D spread;
layout(binding = 2, rgba32f) uniform image3D shift;  // phi_b before

float volume_at(ivec3 c) {
  if (any(lessThan(c, ivec3(0))) || any(greaterThanEqual(c, push.cells))) return 0;
  return imageLoad(volume, ivec3(c.x >> 2, c.yz))[c.x & 3];
}

void main() {
  const ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, push.cells))) return;
  vec3 sum = imageLoad(spread, cell).rgb;
  float size = volume_at(cell) > 0 ? 1 : 0;
  sum *= size;
  for (int n = size > 0 ? 27 : 0; n < 27; ++n) {
    const ivec3 c = cell + ivec3(n % 3, n / 3 % 3, n / 9) - 1;
    const float there = volume_at(c);
    for (int once = there > 0 ? 1 : 0; once > 0; --once) {  // a CPU's lanes would run what stands in an `if`
      sum += there * imageLoad(spread, c).rgb;
      size += there;
    }
  }
  const vec3 mean = size > 0 ? max(sum / size, vec3(0)) : vec3(0);
  imageStore(shift, cell, vec4(mean / push.kept - imageLoad(shift, cell).rgb, 1));
}

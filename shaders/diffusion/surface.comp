// phi and Gamma_s at cell centres, to be sampled trilinearly anywhere on the surface. phi: inner cells as they are, cut cells carried from
// the centroid to the centre along their gradient, slivers and cells outside the mean of what the cut cells around them say.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"
#include "diffusion/cut.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant, scalar) uniform PushBlock { SurfacePush push; };
layout(binding = 3, scalar) readonly buffer Scales { FluenceScale scales[]; };
layout(binding = 4, scalar) readonly buffer Gradients { vec4 gradients[]; };
layout(binding = 5, rgba32f) uniform readonly image3D volume;
layout(binding = 6, rgba32f) uniform readonly image3D phi;
layout(binding = 7, rgba32f) uniform writeonly image3D surface;
layout(binding = 8, scalar) readonly buffer GammaS { vec3 gamma_s[]; };
layout(binding = 9, rgba32f) uniform writeonly image3D surface_gamma;

const float sliver = 0.05;  // h^3; a smaller cut cell's value comes from its neighbours, as if it were outside

// What cut cell `index` says of the point `away` from its low corner, h.
vec3 carried(uint index, vec3 away) {
  vec3 result;
  for (int c = 0; c < 3; ++c) {
    vec4 g = gradients[min(c, push.channels - 1) * push.count + index];
    result[c] = g.w + dot(g.xyz, away - cut_cells[index].centre);
  }
  return result;
}

// Without `needed` the loop is empty: a CPU's vector lanes would run a branch they do not take.
// Gamma_s goes by the facets' areas, phi by the solid's volumes.
vec3 from_neighbours(ivec3 cell, bool needed, out vec3 gamma) {
  vec3 sum = vec3(0);
  vec4 gamma_sum = vec4(0);
  float weights = 0;
  for (int n = needed ? 0 : 27; n < 27; ++n) {
    ivec3 d = ivec3(n % 3, n / 3 % 3, n / 9) - 1;
    uint index = cut_at(cell + d);
    if (index == 0) continue;
    vec3 away = vec3(0.5) - vec3(d), apart = away - cut_cells[index].centre;
    float weight = cut_cells[index].volume / dot(apart, apart);
    sum += weight * carried(index, away);
    weights += weight;
    gamma_sum += cut_cells[index].facet.area * vec4(gamma_s[index], 1);
  }
  gamma = gamma_sum.w > 0 ? gamma_sum.rgb / gamma_sum.w : vec3(0);
  return weights > 0 ? sum / weights : vec3(0);
}

void main() {
  ivec3 t = ivec3(gl_GlobalInvocationID);
  bool near = false;
  for (int n = 0; n < 27 && !near; ++n)
    near = any(greaterThan(imageLoad(volume, t + ivec3(n % 3, n / 3 % 3, n / 9) - 1), vec4(0)));
  vec4 own = imageLoad(volume, t), values[3];
  for (int c = 0; c < 3; ++c) {
    int channel = min(c, push.channels - 1);
    values[c] = imageLoad(phi, t + ivec3(0, 0, channel * push.cells.z)) * scales[channel].unit;
  }
  for (int lane = 0; lane < 4; ++lane) {
    ivec3 cell = ivec3(4 * t.x + lane, t.yz);
    uint index = cut_at(cell);
    bool whole = index == 0 && own[lane] > 0, cut = index != 0 && own[lane] >= sliver;
    vec3 gamma;
    vec3 result = from_neighbours(cell, near && !cut, gamma);
    if (index != 0) gamma = gamma_s[index];
    if (whole) result = vec3(values[0][lane], values[1][lane], values[2][lane]);
    if (cut) result = carried(index, vec3(0.5));
    imageStore(surface, cell, vec4(max(result, vec3(0)), 1));
    imageStore(surface_gamma, cell, vec4(push.channels == 1 ? gamma.rrr : gamma, 1));
  }
}

// The level of the gather on each facet: flux that the diffusion equation sends out there over the flux that the gather does, by
// quadrature over the hemisphere. With it energy is kept as the diffusion equation keeps it, and the gather shapes the light only.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shading/gather_ray.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { GatherPicturePush push; };
layout(binding = 0, scalar) writeonly buffer Levels { vec4 levels[]; };  // two a cut cell
layout(binding = 1, scalar) buffer Counts { uint counts[]; };             // GATHER_* of shared/gather.h

vec4 level_of(uint index, int s) {
  const GpuFacet side = cut_cells[index].side[s];
  const float size = length(side.area_vector);
  if (index == 0 || side.area <= 0 || size <= 0) return vec4(1);
  const vec3 normal = side.area_vector / size, from = vec3(cut_cells[index].cell) + side.centre;
  const vec3 across = normalize(abs(normal.x) < 0.6 ? cross(normal, vec3(1, 0, 0)) : cross(normal, vec3(0, 1, 0)));
  const vec3 other = cross(normal, across);
  vec3 gathered = vec3(0);
  float weights = 0;
  for (int i = 0; i < GATHER_RINGS * GATHER_SECTORS; ++i) {
    const int ring = i / GATHER_SECTORS;
    const float square = (float(ring) + 0.5) / GATHER_RINGS, cosine = sqrt(square), sine = sqrt(1 - square);
    const float angle = 6.28318531 * (float(i % GATHER_SECTORS) + float(ring) / GATHER_RINGS) / GATHER_SECTORS;
    const vec3 outside = cosine * normal + sine * (cos(angle) * across + sin(angle) * other);
    const float weight = fresnel_transmittance(cosine, grid.eta);
    gathered += weight * gather_along(from, normal, refracted_inwards(outside, normal, cosine)).all;
    weights += weight;
  }
  // Both sides: flux that leaves, times 4 / F_dt.
  gathered /= weights;
  const vec3 wanted = bracket_at(from, (facet_class(normal) & 1) == 1);
  vec4 level = vec4(1);
  bool bounded = false;
  for (int c = 0; c < 3; ++c) {
    if (gathered[c] <= 0) continue;
    const float ratio = wanted[c] / gathered[c];
    level[c] = clamp(ratio, GATHER_LEAST_LEVEL, GATHER_MOST_LEVEL);
    bounded = bounded || level[c] != ratio;
  }
  atomicAdd(counts[GATHER_SIDES], 1u);
  if (bounded) atomicAdd(counts[GATHER_BOUNDED], 1u);
  return level;
}

void main() {
  const uint index = gl_GlobalInvocationID.x;
  if (index >= push.count) return;
  // Most cells have one side: the lanes of a CPU work together then.
  const int first = index != 0 && cut_cells[index].side[0].area <= 0 ? 1 : 0;
  levels[2 * index + first] = level_of(index, first);
  levels[2 * index + 1 - first] = level_of(index, 1 - first);
}

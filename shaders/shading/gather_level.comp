// What the diffusion equation sends out through facets and what the gather does, by quadrature over the hemisphere. The quotient
// of their sums is the object's level: so energy is kept as the diffusion equation keeps it, and the gather says where light leaves.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shading/gather_ray.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { GatherLevelPush push; };
layout(binding = 0, scalar) writeonly buffer Fluxes { GatherFlux fluxes[]; };  // of those asked

GatherFlux flux_of(uint index, int s) {
  const GpuFacet side = cut_cells[index].side[s];
  const float size = length(side.area_vector);
  if (index == 0 || side.area <= 0 || size <= 0) return GatherFlux(vec3(0), vec3(0));
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
    gathered += weight * exit_of(cosine) * gather_along(from, normal, refracted_inwards(outside, normal, cosine), 0).all;
    weights += weight;
  }
  return GatherFlux(side.area * bracket_at(from, (facet_class(normal) & 1) == 1),
                    side.area * max(gathered / weights, vec3(0)));
}

void main() {
  const uint k = gl_GlobalInvocationID.x, entry = k * push.stride;
  if (k < push.count) fluxes[k] = flux_of(entry / 2, int(entry % 2));
}

// What each side of each cut cell sends out: radiance over F_t, the bracket of the render query times exit_scale / (4 pi), from
// the same fluence on the facet as in energy.comp. Negative brackets are 0, as in the picture. What goes straight through leaves
// by its flux, spread as the diffuse light is: a bracket of 4 / F_dt times it.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"
#include "diffusion/cut.glsl"
layout(local_size_x = 64) in;
layout(constant_id = 0) const int straight = 0;
layout(push_constant, scalar) uniform PushBlock { SurfacePush push; float exit_scale; uint first; };
#include "diffusion/light.glsl"
layout(binding = 3, scalar) readonly buffer Scales { FluenceScale scales[]; };
layout(binding = 5, rgba32f) uniform readonly image3D phi;
layout(binding = 6, scalar) readonly buffer QueryGamma { vec3 query_gamma[]; };  // as gamma_s
layout(binding = 9, scalar) readonly buffer Through { vec3 through[]; };         // W/m^2, two a cut cell
layout(binding = 7, scalar) readonly buffer FacetOffsets { float facet_offsets[]; };
layout(binding = 8, scalar) writeonly buffer Transmitted { vec3 transmitted[]; };  // W/m^2/sr, from entry `first`

void main() {
  const uint thread = gl_GlobalInvocationID.x, i = thread / 2;
  if (i == 0 || i >= uint(push.count)) return;
  const int side = int(thread & 1);
  const GpuFacet facet = cut_cells[i].side[side];
  if (facet.area <= 0) return;
  const ivec3 c = cut_cells[i].cell;
  vec3 radiance;
  for (int n = 0; n < 3; ++n) {
    const int channel = min(n, push.channels - 1);
    const float own = imageLoad(phi, ivec3(c.x >> 2, c.y, c.z + channel * push.cells.z))[c.x & 3] * scales[channel].unit +
                      facet_offsets[channel * push.count + i];
    const float gamma = gamma_of(i, side)[channel];
    const float depth = max(facet.distance, least_distance) * push.h / facets[i].kappa[channel];
    const float surface = dsbc_surface_fluence(own, dsbc_source(gamma, push.f_dt), push.A, depth);
    const float query = query_gamma[push.sides == 2 ? thread : i][channel];
    float bracket = max(query_bracket(surface, query, push.A, push.f_dt), 0);
    if (straight != 0) bracket += 4 / push.f_dt * through[thread][channel];
    radiance[n] = query_radiance(bracket, 1, exit_scale);
  }
  transmitted[first + thread] = radiance;
}

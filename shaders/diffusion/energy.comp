// Light in and out through the facets, W, and the sum of what absorbed.comp left; one workgroup a channel.
//   in = sum S entering_flux; out = sum S (F_dt / 4) bracket(phi_b), the query's radiance integrated over the hemisphere:
//   integral F_t cos / (4 pi eta^2) = pi (1 - F_dr,ext) / (4 pi eta^2) = F_dt / 4.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"
#include "diffusion/cut.glsl"
layout(local_size_x = 256) in;
layout(push_constant, scalar) uniform PushBlock { SurfacePush push; int partials_per_channel; };
#include "diffusion/light.glsl"
layout(binding = 3, scalar) readonly buffer Scales { FluenceScale scales[]; };
layout(binding = 4, scalar) readonly buffer Partials { float partials[]; };
layout(binding = 5, rgba32f) uniform readonly image3D phi;
layout(binding = 7, scalar) readonly buffer FacetOffsets { float facet_offsets[]; };
layout(binding = 8, scalar) readonly buffer QueryGamma { vec3 query_gamma[]; };  // as gamma_s
layout(binding = 6, scalar) writeonly buffer Sums { EnergySums sums[]; };
shared vec3 shares[256];

void main() {
  int channel = int(gl_WorkGroupID.x), lane = int(gl_LocalInvocationID.x);
  vec3 sum = vec3(0);
  for (int i = 1 + lane; i < push.count; i += 256) {
    ivec3 c = cut_cells[i].cell;
    float own = imageLoad(phi, ivec3(c.x >> 2, c.y, c.z + channel * push.cells.z))[c.x & 3] * scales[channel].unit;
    own += facet_offsets[channel * push.count + i];
    for (int side = 0; side < 2; ++side) {
      GpuFacet facet = cut_cells[i].side[side];
      if (facet.area <= 0) continue;
      float gamma = gamma_of(i, side)[channel], query = query_gamma[push.sides == 2 ? 2 * i + side : i][channel];
      float depth = max(facet.distance, least_distance) * push.h / facets[i].kappa[channel];
      float surface = dsbc_surface_fluence(own, dsbc_source(gamma, push.f_dt), push.A, depth);
      float area = facet.area * push.h * push.h;
      sum.x += area * entering_flux(gamma, query, push.A, push.f_dt);
      sum.z += area * (push.f_dt / 4) * query_bracket(surface, query, push.A, push.f_dt);
    }
  }
  for (int i = lane; i < partials_per_channel; i += 256) sum.y += partials[channel * partials_per_channel + i];
  shares[lane] = sum;
  for (int span = 128; span > 0; span >>= 1) {
    barrier();
    if (lane < span) shares[lane] += shares[lane + span];
  }
  if (lane == 0) sums[channel] = EnergySums(shares[0].x, shares[0].y, shares[0].z);
}

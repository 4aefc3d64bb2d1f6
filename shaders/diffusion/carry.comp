// What surface.comp asks of every cut cell, once for all of its neighbours: on each side of its surface phi as a linear function
// of the place, and the light there.
//
// A cell's phi follows its gradient. Where two sheets lie back to back the gradient says nothing across them: there each side has
// the slope between the cell's value and the fluence on its own sheet, by the series resistance (dsbc_surface_fluence).
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"
#include "diffusion/cut.glsl"
#include "shared/optics.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform PushBlock { SurfacePush push; };
#include "diffusion/light.glsl"
layout(binding = 4, rgba32f) uniform readonly image3D gradients;
layout(binding = 15, scalar) readonly buffer QueryGamma { vec3 query_gamma[]; };  // as gamma_s
// Tables. Layer 2 channel + side: gradient, W/m^2 / h, and value at the cell's low corner; layer side: area query_gamma, area
layout(binding = 16, rgba32f) uniform writeonly image3D lines;
layout(binding = 17, rgba32f) uniform writeonly image3D side_lights;

void main() {
  uint index = gl_GlobalInvocationID.x;
  int channel = int(gl_GlobalInvocationID.y);
  if (index == 0 || index >= uint(push.count)) return;
  vec4 g = imageLoad(gradients, in_table(index, channel));
  vec3 centre = cut_cells[index].centre;
  bool thin = bent(cut_cells[index].facet);
  for (int side = 0; side < 2; ++side) {
    GpuFacet facet = cut_cells[index].side[side];
    vec3 slope = g.xyz;
    if (thin && facet.area > 0) {
      float depth = max(facet.distance, least_distance);
      float q = dsbc_source(gamma_of(index, side)[channel], push.f_dt);
      float sheet = dsbc_surface_fluence(g.w, q, push.A, depth * push.h / facets[index].kappa[channel]);
      vec3 normal = normalize(facet.area_vector);
      slope += normal * ((sheet - g.w) / depth - dot(normal, g.xyz));
    }
    imageStore(lines, in_table(index, 2 * channel + side), vec4(slope, g.w - dot(slope, centre)));
    vec3 light = query_gamma[push.sides == 2 ? 2 * index + side : index];
    imageStore(side_lights, in_table(index, side), facet.area * vec4(light, 1));  // each channel alike
  }
}

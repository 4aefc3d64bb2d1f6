// What joins the unknown of every cut cell to the light on its surface, once for a medium:
//   B = sum over sides of area / (2 A kappa_scale / h + d / k), the share of the upper side in it, and 2 A kappa / h.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"
#include "diffusion/cut.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform PushBlock { OperatorPush push; };
layout(binding = 7, scalar) readonly buffer Facets { FacetMedium facets[]; };
layout(binding = 10, rgba32f) uniform writeonly image3D conductances;  // table, a layer a channel

void main() {
  uint index = gl_GlobalInvocationID.x;
  int channel = int(gl_GlobalInvocationID.y);
  if (index >= uint(push.count)) return;
  float scale = push.kappa_scale[channel], k = facets[index].kappa[channel] / scale;
  float up = side_conductance(index, 0, push.resistance[channel], k);
  float all = up + side_conductance(index, 1, push.resistance[channel], k);
  imageStore(conductances, in_table(index, channel),
             vec4(all, all > 0 ? up / all : 0, 2 * push.resistance[channel] * k, 0));
}

// Of every cut cell: the gradient of phi by least squares over its face neighbours and the boundary condition
// phi_c + g . (x_f - x_c) + 2 A kappa n . g = q at its facet. A constant phi = q gives zero. Lengths in h.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"
#include "diffusion/cut.glsl"
#include "shared/optics.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform PushBlock { SurfacePush push; };
#include "diffusion/light.glsl"
layout(binding = 3, rgba32f) uniform readonly image3D conductances;  // conductances.comp
layout(binding = 5, scalar) readonly buffer Scales { FluenceScale scales[]; };
layout(binding = 6, rgba32f) uniform readonly image3D volume;
layout(binding = 7, rgba32f) uniform readonly image3D phi;
layout(binding = 8, rgba32f) uniform writeonly image3D gradients;  // table of (g, phi_c), W/m^2, a layer a channel
layout(binding = 9, rgba32f) uniform readonly image3D points;

const float regular = 1e-4;       // of the trace: a direction without neighbours gets no slope
const float sliver = 0.05;        // h^3; smaller cells say less: their centroids crowd at the surface

float value(ivec3 c, int channel) {
  return imageLoad(phi, ivec3(c.x >> 2, c.y, c.z + channel * push.cells.z))[c.x & 3] * scales[channel].unit;
}

void main() {
  int index = int(gl_GlobalInvocationID.x), channel = int(gl_GlobalInvocationID.y);
  if (index >= push.count || index == 0) return;
  ivec3 cell;
  for (int axis = 0; axis < 3; ++axis) cell[axis] = int(imageLoad(points, in_table(index, 1 + axis)).w);
  vec3 centre = imageLoad(points, in_table(index, 0)).xyz;
  float own = value(cell, channel);
  mat3 normal_matrix = mat3(0);
  vec3 right = vec3(0);
  for (int n = 0; n < 6; ++n) {
    ivec3 step_ = ivec3(0);
    step_[n >> 1] = (n & 1) != 0 ? 1 : -1;
    ivec3 other = cell + step_;
    float size = imageLoad(volume, ivec3(other.x >> 2, other.yz))[other.x & 3];
    if (size <= 0) continue;
    vec3 d = vec3(step_) + imageLoad(points, in_table(cut_at(other), 0)).xyz - centre;
    float weight = min(1, size / sliver) / dot(d, d);
    normal_matrix += weight * outerProduct(d, d);
    right += weight * (value(other, channel) - own) * d;
  }
  vec4 beside = imageLoad(points, in_table(index, DIFFUSION_POINT_BESIDE));
  vec4 normal = imageLoad(points, in_table(index, DIFFUSION_POINT_NORMAL));
  vec3 d = beside.xyz + (normal.w + imageLoad(conductances, in_table(index, channel)).z) * normal.xyz;
  float weight = dot(d, d) > 0 ? 1 / dot(d, d) : 0;  // bent: none
  normal_matrix += weight * outerProduct(d, d);
  right += weight * (dsbc_source(mean_gamma(index, channel, beside.w), push.f_dt) - own) * d;
  float trace = normal_matrix[0][0] + normal_matrix[1][1] + normal_matrix[2][2];
  vec3 g = trace > 0 ? inverse(normal_matrix + mat3(regular * trace)) * right : vec3(0);
  imageStore(gradients, in_table(index, channel), vec4(g, own));
}

// The finest stencil of the diffusion equation on cut cells, all divided by h * kappa_scale (twin_problem.h):
//   T_f = aperture / (d_i / k_i + d_j / k_j), B_i = sum over sides of area / (2 A kappa_scale / h + d / k), reaction = absorption V + B.
#version 460
#extension GL_GOOGLE_include_directive : require
#define LEVEL_PUSH OperatorPush
#include "diffusion/level.glsl"
#include "diffusion/cut.glsl"
layout(binding = 3, rgba32f) uniform readonly image3D volume;
layout(binding = 4, rgba32f) uniform readonly image3D aperture_x;
layout(binding = 5, rgba32f) uniform readonly image3D aperture_y;
layout(binding = 6, rgba32f) uniform readonly image3D aperture_z;
layout(binding = 7, rgba32f) uniform readonly image3D kappa;       // in kappa_scale
layout(binding = 8, rgba32f) uniform readonly image3D absorption;  // sigma_a h^2 / kappa_scale
layout(binding = 9, rgba32f) uniform writeonly image3D stencil;
layout(binding = 10, scalar) writeonly buffer Conductances { float conductances[]; };  // B, [channel][cut cell]

vec4 conductance(int axis, ivec3 cell, vec4 aperture, vec4 k, vec4 k_below) {
  vec4 result = vec4(0);
  ivec3 below = ivec3(0);
  below[axis] = 1;
  for (int lane = 0; lane < 4; ++lane) {
    if (aperture[lane] <= 0 || k[lane] <= 0 || k_below[lane] <= 0) continue;
    ivec3 c = cell + ivec3(lane, 0, 0);
    float own = max(cut_cells[cut_at(c)].centre[axis], least_distance);
    float other = max(1 - cut_cells[cut_at(c - below)].centre[axis], least_distance);
    result[lane] = aperture[lane] / (own / k[lane] + other / k_below[lane]);
  }
  return result;
}

void main() {
  ivec3 t = texel_here();
  int channel = channel_here(), nx4 = texels(push.cells.x);
  if (t.x >= nx4) return;
  ivec3 cell = ivec3(4 * t.x, t.y, t.z - channel * push.cells.z), s = ivec3(t.xy, cell.z);
  vec4 k = imageLoad(kappa, t), reaction = imageLoad(absorption, t) * imageLoad(volume, s);
  vec4 k_left = shifted_left(imageLoad(kappa, t - step_x), k);
  vec4 k_below = cell.z > 0 ? imageLoad(kappa, t - step_z) : vec4(0);
  for (int lane = 0; lane < 4; ++lane) {
    uint index = cut_at(cell + ivec3(lane, 0, 0));
    if (index == 0 || k[lane] <= 0) continue;
    float b = side_conductance(index, 0, push.resistance[channel], k[lane]) +
              side_conductance(index, 1, push.resistance[channel], k[lane]);
    conductances[channel * push.count + index] = b;
    reaction[lane] += b;
  }
  imageStore(stencil, t, conductance(0, cell, imageLoad(aperture_x, s), k, k_left));
  imageStore(stencil, t + ivec3(nx4, 0, 0), conductance(1, cell, imageLoad(aperture_y, s), k, imageLoad(kappa, t - step_y)));
  imageStore(stencil, t + ivec3(2 * nx4, 0, 0), conductance(2, cell, imageLoad(aperture_z, s), k, k_below));
  imageStore(stencil, t + ivec3(DIFFUSION_REACTION * nx4, 0, 0), reaction);
}

// The finest stencil of the diffusion equation on cut cells, all divided by h * kappa_scale (twin_problem.h):
//   T_f = aperture k_f / (d_i + d_j), reaction = absorption V + B, B from conductances.comp.
// In place: the stencil comes in with k_f, the faces' kappa in kappa_scale, where T_f is to stand.
#version 460
#extension GL_GOOGLE_include_directive : require
#define LEVEL_PUSH OperatorPush
#include "diffusion/level.glsl"
#include "diffusion/cut.glsl"
layout(binding = 3, rgba32f) uniform readonly image3D volume;
layout(binding = 4, rgba32f) uniform readonly image3D aperture_x;
layout(binding = 5, rgba32f) uniform readonly image3D aperture_y;
layout(binding = 6, rgba32f) uniform readonly image3D aperture_z;
layout(binding = 7, rgba32f) uniform readonly image3D points;
layout(binding = 8, rgba32f) uniform readonly image3D absorption;  // sigma_a h^2 / kappa_scale
layout(binding = 9, rgba32f) uniform image3D stencil;
layout(binding = 10, rgba32f) uniform readonly image3D conductances;  // conductances.comp

void join(int axis, ivec3 cell, ivec3 texel, vec4 aperture) {
  vec4 k = imageLoad(stencil, texel), result = vec4(0);
  ivec3 below = ivec3(0);
  below[axis] = 1;
  for (int lane = 0; lane < 4; ++lane) {
    ivec3 c = cell + ivec3(lane, 0, 0);
    float own = max(imageLoad(points, in_table(cut_at(c), 0))[axis], least_distance);
    float other = max(1 - imageLoad(points, in_table(cut_at(c - below), 0))[axis], least_distance);
    if (aperture[lane] > 0) result[lane] = aperture[lane] * k[lane] / (own + other);
  }
  imageStore(stencil, texel, result);
}

void main() {
  ivec3 t = texel_here();
  int channel = channel_here(), nx4 = texels(push.cells.x);
  if (t.x >= nx4) return;
  ivec3 cell = ivec3(4 * t.x, t.y, t.z - channel * push.cells.z), s = ivec3(t.xy, cell.z);
  vec4 reaction = imageLoad(absorption, t) * imageLoad(volume, s);
  for (int lane = 0; lane < 4; ++lane)
    reaction[lane] += imageLoad(conductances, in_table(cut_at(cell + ivec3(lane, 0, 0)), channel)).x;
  join(0, cell, t, imageLoad(aperture_x, s));
  join(1, cell, t + ivec3(nx4, 0, 0), imageLoad(aperture_y, s));
  join(2, cell, t + ivec3(2 * nx4, 0, 0), imageLoad(aperture_z, s));
  imageStore(stencil, t + ivec3(DIFFUSION_REACTION * nx4, 0, 0), reaction);
}

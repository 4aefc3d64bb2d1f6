// Sums the partial sums of one channel a workgroup, always in the same order, and moves the channel's conjugate
// gradients on. A channel that has converged, or broken down, stands still: alpha = beta = 0.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform PushBlock { ReducePush push; };
layout(binding = 0, scalar) readonly buffer Partials { vec4 partials[]; };
layout(binding = 1, scalar) buffer Scalars { CgScalars scalars[]; };
shared float sums[64];  // of the subgroups

void advance(inout CgScalars s, float sum) {
  float square = s.tolerance * s.tolerance;
  bool broken = !(sum >= 0) || isinf(sum);
  if (push.mode == DIFFUSION_REDUCE_START) {
    s.bb = sum;
    s.iterations = 0;
  } else if (push.mode == DIFFUSION_REDUCE_TRUE) {
    s.true_rr = s.rr = sum;
    s.rho = 0;
    s.done = s.bb <= 0 || (sum <= square * s.bb && s.scaled_rr <= DIFFUSION_SCALED * DIFFUSION_SCALED * square * s.xx) ? 1 : 0;
  } else if (push.mode == DIFFUSION_REDUCE_BETA) {
    s.beta = s.done == 0 && s.rho > 0 ? sum / s.rho : 0;
    s.rho = sum;
  } else if (push.mode == DIFFUSION_REDUCE_ALPHA) {
    s.alpha = s.done == 0 && sum > 0 ? s.rho / sum : 0;
    broken = broken || sum == 0;
  } else if (push.mode == DIFFUSION_REDUCE_SCALED) {
    s.scaled_rr = sum;
  } else if (push.mode == DIFFUSION_REDUCE_SIZE) {
    s.xx = sum;
  } else {
    s.rr = sum;
    if (s.done == 0) {
      s.iterations += 1;
      if (sum <= s.target * s.target * s.bb) s.done = 1;
    }
  }
  if (broken && s.done == 0) {
    s.done = 2;
    s.alpha = s.beta = 0;
  }
}

void main() {
  uint channel = gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
  uint count = push.partials / 4, begin = push.first / 4 + channel * count;  // a workgroup leaves a multiple of four
  vec4 four = vec4(0);
  for (uint i = lane; i < count; i += 64) four += partials[begin + i];
  float sum = subgroupAdd(four.x + four.y + four.z + four.w);
  if (subgroupElect()) sums[gl_SubgroupID] = sum;
  barrier();
  if (lane == 0) {
    CgScalars s = scalars[channel];
    float total = 0;
    for (uint i = 0; i < gl_NumSubgroups; ++i) total += sums[i];
    advance(s, total);
    scalars[channel] = s;
  }
}

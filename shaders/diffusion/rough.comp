// How rough the medium of each channel is, by the finest stencil: Roughness in shared/diffusion.h.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/stencil.glsl"
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
layout(binding = 2, scalar) buffer Counts { Roughness counts[]; };

vec4 least(Faces f) { return min(min(min(f.left, f.right), min(f.down, f.up)), min(f.below, f.above)); }
vec4 most(Faces f) { return max(max(max(f.left, f.right), max(f.down, f.up)), max(f.below, f.above)); }

// 1 where a cell has six faces.
vec4 whole(Faces f) { return vec4(greaterThan(least(f), vec4(0))); }
vec4 whole_at(ivec3 t) { return whole(faces_of(t, coefficient(2, t))); }

vec4 if_above(vec4 bound, vec4 face) { return mix(vec4(1e38), face, greaterThan(face, bound)); }

// 1 where faces are of three magnitudes: the least, the next above it, and one above that.
vec4 noise(Faces f) {
  vec4 bound = DIFFUSION_MAGNITUDE * least(f);
  vec4 next = min(if_above(bound, f.left), if_above(bound, f.right));
  next = min(next, min(if_above(bound, f.down), if_above(bound, f.up)));
  next = min(next, min(if_above(bound, f.below), if_above(bound, f.above)));
  return vec4(greaterThan(most(f), DIFFUSION_MAGNITUDE * next));
}

uint sum(vec4 v) { return subgroupAdd(uint(v.x + v.y + v.z + v.w)); }

void main() {
  Column column = column_here();
  ivec3 t = column.texel;
  vec4 cells = vec4(0), within = vec4(0), jumps = vec4(0), noisy = vec4(0), deep = vec4(0), deep_jumps = vec4(0);
  for (int k = 0; k < column.layers; ++k, ++t.z) {
    Faces f = faces_of(t, coefficient(2, t));
    vec4 own = whole(f), jump = own * vec4(greaterThan(most(f), DIFFUSION_JUMP * least(f)));
    vec4 inner = own * shifted_left(whole_at(t - step_x), own) * shifted_right(own, whole_at(t + step_x));
    inner *= whole_at(t - step_y) * whole_at(t + step_y) * whole_at(t - step_z) * whole_at(t + step_z);
    cells += vec4(greaterThan(f.reaction + most(f), vec4(0)));
    within += own;
    jumps += jump;
    noisy += jump * noise(f);
    deep += inner;
    deep_jumps += inner * jump;
  }
  Roughness found = Roughness(sum(cells), sum(within), sum(jumps), sum(noisy), sum(deep), sum(deep_jumps));
  if (subgroupElect()) {
    int channel = channel_here();
    atomicAdd(counts[channel].all, found.all);
    atomicAdd(counts[channel].within, found.within);
    atomicAdd(counts[channel].jumps, found.jumps);
    atomicAdd(counts[channel].noisy, found.noisy);
    atomicAdd(counts[channel].deep, found.deep);
    atomicAdd(counts[channel].deep_jumps, found.deep_jumps);
  }
}

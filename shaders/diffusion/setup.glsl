// Reading a fine level's stencil at every second cell, for the coarse texel t (its four cells I): fine cells 2 I + s.
#include "diffusion/stencil.glsl"
layout(binding = 2, rgba32f) uniform readonly image3D diagonal;  // of the finest level; not read on the others

const int no_entry = -1;

vec4 read_fine(int entry, ivec3 fine_texel) {
  return entry == no_entry ? imageLoad(diagonal, fine_texel) : coefficient(entry, fine_texel);
}

// Entry (or the diagonal) at cells 2 I + s, s.x in -2..2; zero outside the grid. `base`: fine texel of cell 2 I, s = 0.
vec4 gather(int entry, ivec3 base, ivec3 s, int channel) {
  ivec3 f = base + ivec3(0, s.yz);
  int z = f.z - channel * push.cells.z;
  if (z < 0 || z >= push.cells.z) return vec4(0);
  vec4 low = read_fine(entry, f), high = read_fine(entry, f + step_x), result;
  if (s.x == 0) {
    result = vec4(low.xz, high.xz);
  } else if (s.x == 1) {
    result = vec4(low.yw, high.yw);
  } else if (s.x == 2) {
    result = vec4(low.z, high.xz, read_fine(entry, f + 2 * step_x).x);
  } else {
    vec4 before = read_fine(entry, f - step_x);
    result = s.x == -1 ? vec4(before.w, low.yw, high.y) : vec4(before.z, low.xz, high.x);
  }
  ivec4 x = 4 * base.x + ivec4(0, 2, 4, 6) + s.x;
  return mix(vec4(0), result, lessThan(uvec4(x), uvec4(push.cells.x)));
}

// A(2 I + d, 2 I + d + e)
vec4 coupling(ivec3 base, ivec3 d, ivec3 e, int channel) {
  int k = (e.x + 1) + 3 * (e.y + 1) + 9 * (e.z + 1);
  if (finest == 0) return k <= DIFFUSION_DIAGONAL ? gather(k, base, d, channel) : gather(26 - k, base, d + e, channel);
  if (k == DIFFUSION_DIAGONAL) return gather(no_entry, base, d, channel);
  int axis = e.x != 0 ? 0 : e.y != 0 ? 1 : 2;
  return -gather(axis, base, e[axis] < 0 ? d : d + e, channel);
}

vec4 diagonal_at(ivec3 base, ivec3 d, int channel) {
  return gather(finest != 0 ? no_entry : DIFFUSION_DIAGONAL, base, d, channel);
}

ivec3 fine_base(ivec3 t, int channel) {
  return ivec3(2 * t.xy, 2 * (t.z - channel * push.coarse_cells.z) + channel * push.cells.z);
}

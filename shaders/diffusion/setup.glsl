// For set-up passes that have a texel of four coarse cells I: what the fine cells near 2 I hold.
layout(binding = 1, rgba32f) uniform readonly image3D stencil;
layout(binding = 2, rgba32f) uniform readonly image3D diagonal;

const int own_entry = finest != 0 ? DIFFUSION_REACTION : DIFFUSION_ROW_SUM;

struct Line {  // 16 cells of a fine row, from 4 before the first coarse cell's own
  vec4 before, low, high, after;
};

Line line_of(int entry, ivec3 t) {
  ivec3 s = t + entry * texels(push.cells.x) * step_x;
  return Line(imageLoad(stencil, s - step_x), imageLoad(stencil, s), imageLoad(stencil, s + step_x),
              imageLoad(stencil, s + 2 * step_x));
}

// Of the fine cells 2 I + q, q = -2..2.
vec4 at(Line a, int q) {
  vec4 even = q < 0 ? vec4(a.before.z, a.low.xz, a.high.x) : q > 0 ? vec4(a.low.z, a.high.xz, a.after.x) : vec4(a.low.xz, a.high.xz);
  vec4 odd = q < 0 ? vec4(a.before.w, a.low.yw, a.high.y) : vec4(a.low.yw, a.high.yw);
  return (q & 1) != 0 ? odd : even;
}

vec4 diagonal_at(ivec3 t, int q) {  // q = -1..1
  return at(Line(imageLoad(diagonal, t - step_x), imageLoad(diagonal, t), imageLoad(diagonal, t + step_x), vec4(0)), q);
}

int entry(ivec3 d) { return (d.x + 1) + 3 * (d.y + 1) + 9 * (d.z + 1); }

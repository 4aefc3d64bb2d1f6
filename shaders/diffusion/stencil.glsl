// The level's stencil: shared/diffusion.h says what its entries are.
layout(binding = 1, rgba32f) uniform readonly image3D stencil;

const int own_entry = finest != 0 ? DIFFUSION_REACTION : DIFFUSION_ROW_SUM;

vec4 coefficient(int entry, ivec3 t) { return imageLoad(stencil, ivec3(entry * texels(push.cells.x) + t.x, t.yz)); }

// The same of the texels at either side, zero beyond the grid, where another entry's texels lie.
vec4 coefficient_left(int entry, ivec3 t) { return float(t.x > 0) * coefficient(entry, t - step_x); }
vec4 coefficient_right(int entry, ivec3 t) {
  return float(t.x + 1 < texels(push.cells.x)) * coefficient(entry, t + step_x);
}

// The finest stencil at a texel; whoever walks up a column takes face_above on as face_below.
struct Faces {
  vec4 left, right, down, up, below, above, reaction;
};

Faces faces_of(ivec3 t, vec4 below) {
  vec4 left = coefficient(0, t);
  return Faces(left, shifted_right(left, coefficient(0, t + step_x)), coefficient(1, t), coefficient(1, t + step_y),
               below, coefficient(2, t + step_z), coefficient(DIFFUSION_REACTION, t));
}

// -A(i, i + offset(n)) for n = 0..26 but 13; on the finest level for axes.
vec4 conductance(int n, ivec3 t) {
  ivec3 d = offset(n);
  if (finest != 0) {
    int axis = abs(d.y) + 2 * abs(d.z);
    vec4 own = coefficient(axis, t + max(ivec3(0, d.yz), ivec3(0)));
    return d.x > 0 ? shifted_right(own, coefficient_right(axis, t)) : own;
  }
  if (n < 13) return -coefficient(n, t);
  int k = 26 - n;
  ivec3 s = t + ivec3(0, d.yz);
  vec4 own = coefficient(k, s);
  return -(d.x == 0 ? own : d.x > 0 ? shifted_right(own, coefficient_right(k, s)) : shifted_left(coefficient_left(k, s), own));
}

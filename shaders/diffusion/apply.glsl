// (A x)(t) for the image `x`.
#include "diffusion/stencil.glsl"
layout(binding = 2, rgba32f) uniform readonly image3D x;

// x at a texel and at its neighbours.
struct Star {
  vec4 own, left, right, down, up, below, above;
};

// Of three layers the one in the middle is the texel's own.
struct Layers {
  vec4 below, own, above;
};

Star star_of_x(ivec3 t, Layers z) {
  return Star(z.own, shifted_left(imageLoad(x, t - step_x), z.own), shifted_right(z.own, imageLoad(x, t + step_x)),
              imageLoad(x, t - step_y), imageLoad(x, t + step_y), z.below, z.above);
}

vec4 apply_to(Star s, Faces f) {
  vec4 y = f.reaction * s.own + f.left * (s.own - s.left) + f.right * (s.own - s.right);
  y += f.down * (s.own - s.down) + f.up * (s.own - s.up);
  return y + f.below * (s.own - s.below) + f.above * (s.own - s.above);
}

vec4 apply_finest(ivec3 t) {
  Layers z = Layers(imageLoad(x, t - step_z), imageLoad(x, t), imageLoad(x, t + step_z));
  return apply_to(star_of_x(t, z), faces_of(t, coefficient(2, t)));
}

// Of the cells in one row of texels: those to the left, above or below, to the right, less `centre`.
struct Row3 {
  vec4 left, own, right;
};

Row3 row_of_x(ivec3 s, vec4 centre) {
  vec4 own = imageLoad(x, s);
  return Row3(shifted_left(imageLoad(x, s - step_x), own) - centre, own - centre,
              shifted_right(own, imageLoad(x, s + step_x)) - centre);
}

// Rows with entries of their own, then those whose entries are their cells': apart, since a CPU's vector lanes run every
// branch of a loop's body.
vec4 apply_coarse(ivec3 t) {
  vec4 centre = imageLoad(x, t), y = coefficient(DIFFUSION_ROW_SUM, t) * centre;
  for (int row = 0; row < 4; ++row) {
    ivec3 d = ivec3(0, row % 3 - 1, row / 3 - 1);
    int k = 3 * row;
    Row3 below = row_of_x(t + d, centre), above = row_of_x(t - d, centre);
    y += coefficient(k, t) * below.left + coefficient(k + 1, t) * below.own + coefficient(k + 2, t) * below.right;
    ivec3 s = t - d;
    vec4 to_left = shifted_left(coefficient_left(k + 2, s), coefficient(k + 2, s));
    vec4 to_right = shifted_right(coefficient(k, s), coefficient_right(k, s));
    y += to_left * above.left + coefficient(k + 1, s) * above.own + to_right * above.right;
  }
  Row3 row = row_of_x(t, centre);
  vec4 low = coefficient(12, t);
  return y + low * row.left + shifted_right(low, coefficient_right(12, t)) * row.right;
}

vec4 apply(ivec3 t) { return finest != 0 ? apply_finest(t) : apply_coarse(t); }

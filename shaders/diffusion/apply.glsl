// (A x)(t) for the image `x`.
#include "diffusion/stencil.glsl"
layout(binding = 2, rgba32f) uniform readonly image3D x;

// x at a texel and at its neighbours.
struct Star {
  vec4 own, left, right, down, up, below, above;
};

Star star_of_x(ivec3 t) {
  vec4 own = imageLoad(x, t);
  return Star(own, shifted_left(imageLoad(x, t - step_x), own), shifted_right(own, imageLoad(x, t + step_x)),
              imageLoad(x, t - step_y), imageLoad(x, t + step_y), imageLoad(x, t - step_z), imageLoad(x, t + step_z));
}

vec4 apply_to(Star s, ivec3 t) {
  vec4 face_x = coefficient(0, t), y = coefficient(DIFFUSION_REACTION, t) * s.own;
  y += face_x * (s.own - s.left) + shifted_right(face_x, coefficient(0, t + step_x)) * (s.own - s.right);
  y += coefficient(1, t) * (s.own - s.down) + coefficient(1, t + step_y) * (s.own - s.up);
  y += coefficient(2, t) * (s.own - s.below) + coefficient(2, t + step_z) * (s.own - s.above);
  return y;
}

vec4 apply_finest(ivec3 t) { return apply_to(star_of_x(t), t); }

vec4 apply_coarse(ivec3 t) {
  vec4 centre = imageLoad(x, t), y = coefficient(DIFFUSION_ROW_SUM, t) * centre;
  for (int row = 0; row < 9; ++row) {
    ivec3 s = t + ivec3(0, row % 3 - 1, row / 3 - 1);
    vec4 own = imageLoad(x, s);
    vec4 left = shifted_left(imageLoad(x, s - step_x), own) - centre;
    vec4 right = shifted_right(own, imageLoad(x, s + step_x)) - centre;
    own -= centre;
    int k = 3 * row;
    if (row < 4) {
      y += coefficient(k, t) * left + coefficient(k + 1, t) * own + coefficient(k + 2, t) * right;
    } else if (row == 4) {
      vec4 low = coefficient(k, t);
      y += low * left + shifted_right(low, coefficient_right(k, t)) * right;
    } else {
      vec4 to_left = shifted_left(coefficient_left(26 - k, s), coefficient(26 - k, s));
      vec4 to_right = shifted_right(coefficient(24 - k, s), coefficient_right(24 - k, s));
      y += to_left * left + coefficient(25 - k, s) * own + to_right * right;
    }
  }
  return y;
}

vec4 apply(ivec3 t) { return finest != 0 ? apply_finest(t) : apply_coarse(t); }

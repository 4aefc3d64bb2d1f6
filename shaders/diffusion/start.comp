// r = b - A (x + rest) and the first smoothing step of a cycle: z = omega D^-1 r. What x and rest have is subtracted
// apart: their sum has not the digits (update.comp). Three sums: r . r, |D^-1 r|^2 and x . x.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/apply.glsl"
#include "diffusion/partial.glsl"
layout(binding = 4, rgba32f) uniform readonly image3D inverse_l1;
layout(binding = 5, rgba32f) uniform readonly image3D b;
layout(binding = 6, rgba32f) uniform writeonly image3D r;
layout(binding = 7, rgba32f) uniform writeonly image3D z;
layout(binding = 8, rgba32f) uniform readonly image3D rest;

Star star_of_rest(ivec3 t, Layers z) {
  return Star(z.own, shifted_left(imageLoad(rest, t - step_x), z.own),
              shifted_right(z.own, imageLoad(rest, t + step_x)), imageLoad(rest, t - step_y),
              imageLoad(rest, t + step_y), z.below, z.above);
}

void main() {
  Column column = column_here();
  ivec3 t = column.texel;
  Layers high = Layers(imageLoad(x, t - step_z), imageLoad(x, t), vec4(0));
  Layers low = Layers(imageLoad(rest, t - step_z), imageLoad(rest, t), vec4(0));
  vec4 face_below = coefficient(2, t);
  vec3 sums = vec3(0);
  for (int k = 0; k < column.layers; ++k, ++t.z) {
    high.above = imageLoad(x, t + step_z);
    low.above = imageLoad(rest, t + step_z);
    Faces faces = faces_of(t, face_below);
    vec4 left = imageLoad(b, t) - apply_to(star_of_rest(t, low), faces);
    vec4 residual = left - apply_to(star_of_x(t, high), faces), scaled = imageLoad(inverse_l1, t) * residual;
    imageStore(r, t, residual);
    imageStore(z, t, push.omega * scaled);
    sums += vec3(dot(residual, residual), dot(scaled, scaled), dot(high.own, high.own));
    high = Layers(high.own, high.above, vec4(0));
    low = Layers(low.own, low.above, vec4(0));
    face_below = faces.above;
  }
  for (int k = 0; k < 3; ++k) leave_partial(k, sums[k]);
}

// product = A x on the finest level, and x . product
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/apply.glsl"
#include "diffusion/partial.glsl"
layout(binding = 6, rgba32f) uniform writeonly image3D product;

void main() {
  Column column = column_here();
  ivec3 t = column.texel;
  Layers z = Layers(imageLoad(x, t - step_z), imageLoad(x, t), vec4(0));
  vec4 face_below = coefficient(2, t);
  float sum = 0;
  for (int k = 0; k < column.layers; ++k, ++t.z) {
    z.above = imageLoad(x, t + step_z);
    Faces faces = faces_of(t, face_below);
    vec4 y = apply_to(star_of_x(t, z), faces);
    imageStore(product, t, y);
    sum += dot(z.own, y);
    z = Layers(z.own, z.above, vec4(0));
    face_below = faces.above;
  }
  leave_partial(sum);
}

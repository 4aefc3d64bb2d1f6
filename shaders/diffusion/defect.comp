// The residual within a cycle: defect = b - A x by the packed stencil.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "diffusion/level.glsl"
#include "diffusion/packed.glsl"
layout(binding = 5, rgba32f) uniform readonly image3D b;
layout(binding = 6, rgba32f) uniform writeonly image3D defect;

void leave(ivec3 t, Applied a) { imageStore(defect, t, imageLoad(b, t) - a.product); }

void main() {
  if (finest == 0) {
    ivec3 t = texel_here();
    leave(t, apply_on_coarse(t));
  } else {
    Column column = column_here();
    ivec3 t = column.texel;
    Layers z = Layers(imageLoad(x, t - step_z), imageLoad(x, t), vec4(0));
    for (int k = 0; k < column.layers; ++k, ++t.z) {
      z.above = imageLoad(x, t + step_z);
      leave(t, apply_packed(t, z));
      z = Layers(z.own, z.above, vec4(0));
    }
  }
}

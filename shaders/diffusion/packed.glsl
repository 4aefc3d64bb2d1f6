// What a cycle applies: on the finest level the packed stencil (shared/diffusion.h), on the others the stencil itself.
#include "diffusion/apply.glsl"
layout(binding = 4, rgba32f) uniform readonly image3D inverse_l1;
layout(binding = 8, rgba32ui) uniform readonly uimage3D pairs;  // of the finest level

uvec4 pair(int k, ivec3 t) { return imageLoad(pairs, ivec3(k * texels(push.cells.x) + t.x, t.yz)); }
vec4 low(uvec4 two) { return uintBitsToFloat(two << 16); }
vec4 high(uvec4 two) { return uintBitsToFloat(two & 0xffff0000u); }

struct Applied {
  vec4 centre, product, inverse_l1;  // x, A x and D^-1 at the texel
};

Applied apply_packed(ivec3 t, Layers z) {
  vec4 own = z.own;
  uvec4 along_x = pair(0, t), along_y = pair(1, t), along_z = pair(2, t), rest = pair(3, t);
  vec4 y = low(rest) * own + low(along_x) * (own - shifted_left(imageLoad(x, t - step_x), own));
  y += high(along_x) * (own - shifted_right(own, imageLoad(x, t + step_x)));
  y += low(along_y) * (own - imageLoad(x, t - step_y)) + high(along_y) * (own - imageLoad(x, t + step_y));
  y += low(along_z) * (own - z.below) + high(along_z) * (own - z.above);
  return Applied(own, y, high(rest));
}

Applied apply_on_coarse(ivec3 t) {
  return Applied(imageLoad(x, t), apply_coarse(t), imageLoad(inverse_l1, t));
}

// The level's stencil: shared/diffusion.h says what its entries are.
layout(binding = 1, rgba32f) uniform readonly image3D stencil;

vec4 coefficient(int entry, ivec3 t) { return imageLoad(stencil, ivec3(entry * texels(push.cells.x) + t.x, t.yz)); }

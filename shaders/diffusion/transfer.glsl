// Between a level of push.cells and the next coarser one of push.coarse_cells. weights: entry k of coarse cell I is what
// fine cell 2 I + offset(k) takes from it; zero for fine cells that are none.
layout(binding = 7, rgba32f) uniform readonly image3D weights;

vec4 weight(int k, ivec3 coarse_texel) {
  return imageLoad(weights, ivec3(k * texels(push.coarse_cells.x) + coarse_texel.x, coarse_texel.yz));
}

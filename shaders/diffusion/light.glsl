// Gamma_s and the medium at the surface of the cut cells. Include after cut.glsl, with a SurfacePush named push.
layout(binding = 13, scalar) readonly buffer GammaS { vec3 gamma_s[]; };  // W/m^2, push.sides a cut cell
layout(binding = 14, scalar) readonly buffer Facets { FacetMedium facets[]; };

vec3 gamma_of(uint index, int side) { return gamma_s[push.sides == 2 ? 2 * index + side : index]; }

// Mean over the sides: `upper_share` by area, or by conductance, as the cell's one unknown feels them.
float mean_gamma(uint index, int channel, float upper_share) {
  return upper_share * gamma_of(index, 0)[channel] + (1 - upper_share) * gamma_of(index, 1)[channel];
}

// Gamma_s and the medium at the surface of the cut cells. Include after cut.glsl, with a SurfacePush named push.
layout(binding = 13, scalar) readonly buffer GammaS { vec3 gamma_s[]; };  // W/m^2, push.sides a cut cell
layout(binding = 14, scalar) readonly buffer Facets { FacetMedium facets[]; };

vec3 gamma_of(uint index, int side) { return gamma_s[push.sides == 2 ? 2 * index + side : index]; }

// Mean over the sides by area.
float mean_gamma(uint index, int channel) {
  float up = cut_cells[index].side[0].area, down = cut_cells[index].side[1].area;
  return up + down > 0 ? (up * gamma_of(index, 0)[channel] + down * gamma_of(index, 1)[channel]) / (up + down) : 0;
}

// Mean by conductance: what the cell's one unknown feels of the two.
float driving_gamma(uint index, int channel) {
  float k = facets[index].kappa[channel] / push.h;
  float up = side_conductance(index, 0, push.A, k), down = side_conductance(index, 1, push.A, k);
  return up + down > 0 ? (up * gamma_of(index, 0)[channel] + down * gamma_of(index, 1)[channel]) / (up + down) : 0;
}

// What each cut cell adds to the right-hand side: b = B (q - o) / unit plus the corrections of its faces.
//
// The first-order matrix takes phi at the centroids as if they lay on the line through the wetted face's centroid (or
// below the facet's). With the gradients g of the solution before, phi is carried there: o = g . (tangential offset), and
// a face's flux becomes T ((phi_j + o_j) - (phi_i + o_i)): deferred correction, second order. |o| <= phi / 4 keeps the
// fluence positive. Both sides compute the same flux, so the light is conserved.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"
#include "diffusion/cut.glsl"
#include "shared/optics.h"
layout(local_size_x = 64) in;
layout(constant_id = 0) const int corrected = 0;
layout(push_constant, scalar) uniform PushBlock { SurfacePush push; };
layout(binding = 3, scalar) readonly buffer Conductances { float conductances[]; };  // [channel][cut cell]
#include "diffusion/light.glsl"
layout(binding = 5, scalar) readonly buffer Scales { FluenceScale scales[]; };
layout(binding = 6, rgba32f) uniform readonly image3D gradients;                      // (g, phi_c), W/m^2
layout(binding = 7, rgba32f) uniform readonly image3D stencil;
layout(binding = 8, scalar) writeonly buffer CellSources { float cell_sources[]; };
layout(binding = 9, scalar) writeonly buffer FaceFluxes { float face_fluxes[]; };    // into the cell, faces -x +x -y ...
layout(binding = 11, rgba32f) uniform readonly image3D points;
layout(binding = 10, scalar) writeonly buffer FacetOffsets { float facet_offsets[]; };  // o below the facet, W/m^2

float offset_value(uint index, int channel, vec3 away) {
  vec4 g = imageLoad(gradients, in_table(index, channel));
  return clamp(dot(g.xyz, away), -0.25 * abs(g.w), 0.25 * abs(g.w));
}

// Towards face `f` of cell `index`; entry 0, a whole cell, has no offset.
float face_offset(uint index, int channel, int f, vec3 face_centre) {
  if (index == 0) return 0;
  vec3 away = face_centre - imageLoad(points, in_table(index, 0)).xyz;
  away[f >> 1] = 0;
  return offset_value(index, channel, away);
}

float conductance(ivec3 cell, int axis, int channel) {
  int nx4 = (push.cells.x + 3) >> 2;
  return imageLoad(stencil, ivec3(axis * nx4 + (cell.x >> 2), cell.y, cell.z + channel * push.cells.z))[cell.x & 3];
}

// Correction of the flux into the cell through face f, W/m^2 in the matrix's scale.
float face_flux(uint index, ivec3 cell, int channel, int f) {
  int axis = f >> 1, up = f & 1;
  ivec3 other = cell;
  other[axis] += 2 * up - 1;
  ivec3 upper = up != 0 ? other : cell;  // the cell whose low face this is
  vec3 centre = imageLoad(points, in_table(cut_at(upper), 1 + axis)).xyz, mine = centre, theirs = centre;
  mine[axis] += up;
  theirs[axis] += 1 - up;
  return conductance(upper, axis, channel) *
         (face_offset(cut_at(other), channel, f, theirs) - face_offset(index, channel, f, mine));
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  int channel = int(gl_GlobalInvocationID.y), at = channel * push.count + int(index);
  if (index >= uint(push.count)) return;
  float unit = scales[channel].unit, per_unit = unit > 0 ? 1 / unit : 0, offset_below = 0, source = 0;
  for (int f = 0; f < 6; ++f) {
    float flux = corrected != 0 && index != 0 ? face_flux(index, cut_cells[index].cell, channel, f) * per_unit : 0;
    face_fluxes[6 * at + f] = flux;
    source += flux;
  }
  if (index != 0) {
    GpuFacet facet = cut_cells[index].facet;
    if (corrected != 0 && !bent(facet)) {
      vec3 normal = normalize(facet.area_vector), away = facet.centre - cut_cells[index].centre;
      offset_below = offset_value(index, channel, away - normal * dot(away, normal));
    }
    source += conductances[at] * (dsbc_source(driving_gamma(index, channel), push.f_dt) - offset_below) * per_unit;
  }
  cell_sources[at] = source;
  facet_offsets[at] = offset_below;
}

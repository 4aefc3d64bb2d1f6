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
layout(binding = 3, rgba32f) uniform readonly image3D conductances;  // conductances.comp
#include "diffusion/light.glsl"
layout(binding = 5, scalar) readonly buffer Scales { FluenceScale scales[]; };
layout(binding = 6, rgba32f) uniform readonly image3D gradients;  // (g, phi_c), W/m^2
layout(binding = 7, rgba32f) uniform readonly image3D stencil;
layout(binding = 8, scalar) writeonly buffer CellSources { float cell_sources[]; };  // [cut cell, then the rim][channel]
layout(binding = 9, rgba32f) uniform writeonly image3D face_fluxes;  // into the cell; layers 2 channel: -x +x -y +y, then -z +z
layout(binding = 11, rgba32f) uniform readonly image3D points;
layout(binding = 10, scalar) writeonly buffer FacetOffsets { float facet_offsets[]; };  // o below the facet, W/m^2

float offset_value(vec4 g, vec3 away) { return clamp(dot(g.xyz, away), -0.25 * abs(g.w), 0.25 * abs(g.w)); }

float conductance(ivec3 cell, int axis, int channel) {
  int nx4 = (push.cells.x + 3) >> 2;
  return imageLoad(stencil, ivec3(axis * nx4 + (cell.x >> 2), cell.y, cell.z + channel * push.cells.z))[cell.x & 3];
}

struct CutCell {
  ivec3 cell;
  vec4 low_faces[3], gradient;  // tables' entries
  vec3 centre;
};

CutCell cut_cell(uint index, int channel) {
  CutCell own;
  for (int axis = 0; axis < 3; ++axis) {
    own.low_faces[axis] = imageLoad(points, in_table(index, 1 + axis));
    own.cell[axis] = int(own.low_faces[axis].w);
  }
  own.gradient = imageLoad(gradients, in_table(index, channel));
  own.centre = imageLoad(points, in_table(index, 0)).xyz;
  return own;
}

// Correction of the flux into the cell through its upper or lower face, W/m^2 in the matrix's scale. A whole cell has no offset.
float face_flux(CutCell own, int channel, int axis, int up) {
  ivec3 other = own.cell;
  other[axis] += 2 * up - 1;
  uint there = cut_at(other);
  vec3 mine = up != 0 ? imageLoad(points, in_table(there, 1 + axis)).xyz : own.low_faces[axis].xyz, theirs = mine;
  theirs -= imageLoad(points, in_table(there, 0)).xyz;
  mine -= own.centre;
  mine[axis] = theirs[axis] = 0;
  float offset_there = there != 0 ? offset_value(imageLoad(gradients, in_table(there, channel)), theirs) : 0;
  return conductance(up != 0 ? other : own.cell, axis, channel) * (offset_there - offset_value(own.gradient, mine));
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  int channel = int(gl_GlobalInvocationID.y);
  if (index >= uint(push.count)) return;
  float unit = scales[channel].unit, per_unit = unit > 0 && index != 0 ? 1 / unit : 0, offset_below = 0, source = 0;
  if (corrected != 0) {
    CutCell own = cut_cell(index, channel);
    vec2 fluxes[3];
    for (int axis = 0; axis < 3; ++axis) {
      fluxes[axis] = vec2(face_flux(own, channel, axis, 0), face_flux(own, channel, axis, 1)) * per_unit;
      if (index == 0) fluxes[axis] = vec2(0);  // its gradient is none
      source += fluxes[axis].x + fluxes[axis].y;
    }
    imageStore(face_fluxes, in_table(index, 2 * channel), vec4(fluxes[0], fluxes[1]));
    imageStore(face_fluxes, in_table(index, 2 * channel + 1), vec4(fluxes[2], vec2(0)));
    if (index != 0) offset_below = offset_value(own.gradient, imageLoad(points, in_table(index, DIFFUSION_POINT_BESIDE)).xyz);
  }
  vec4 joined = imageLoad(conductances, in_table(index, channel));
  source += joined.x * (dsbc_source(mean_gamma(index, channel, joined.y), push.f_dt) - offset_below) * per_unit;
  cell_sources[index * push.channels + channel] = source;
  facet_offsets[channel * push.count + index] = offset_below;
}

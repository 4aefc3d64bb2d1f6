// The table of the cut cells' points, from the domain's list: shared/diffusion.h says what is where.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/diffusion.h"
#include "diffusion/cut.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform PushBlock { SurfacePush push; };
layout(binding = 3, rgba32f) uniform writeonly image3D points;

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= uint(push.count)) return;
  imageStore(points, in_table(index, 0), vec4(cut_cells[index].centre, cut_cells[index].volume));
  for (int axis = 0; axis < 3; ++axis)
    imageStore(points, in_table(index, 1 + axis), vec4(cut_cells[index].low_face_centre[axis], cut_cells[index].cell[axis]));
  GpuFacet facet = cut_cells[index].facet;
  float up = cut_cells[index].side[0].area, all = up + cut_cells[index].side[1].area;
  vec3 normal = bent(facet) ? vec3(0) : normalize(facet.area_vector), away = facet.centre - cut_cells[index].centre;
  float height = dot(away, normal);
  vec3 beside = float(!bent(facet)) * (away - height * normal);
  imageStore(points, in_table(index, DIFFUSION_POINT_BESIDE), vec4(beside, all > 0 ? up / all : 0));
  imageStore(points, in_table(index, DIFFUSION_POINT_NORMAL), vec4(normal, height));
}

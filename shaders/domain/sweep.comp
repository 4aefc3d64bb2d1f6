// Apertures and first moments of the faces across one axis: running sums along it from the empty margin. One thread a row
// of texels (four x-neighbours each); along x the four follow one another.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "sums.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const int axis = 0;
layout(push_constant, scalar) uniform Push { DomainPush push; };
layout(binding = 0, scalar) readonly buffer Bits { uint bits[]; };
layout(binding = 1, scalar) readonly buffer Before { uint before[]; };
// By candidate and axis; in: integral n_axis (1, x) dA, out: aperture and first moments of the low face.
layout(binding = 2, scalar) buffer Faces { ivec4 faces[]; };
layout(binding = 3, scalar) buffer Status { DomainStatus status; };
layout(binding = 4, rgba32f) uniform writeonly image3D aperture;

void main() {
  ivec3 texels = ivec3(push.cells.x / 4, push.cells.yz);
  const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
  ivec3 texel;
  texel[u] = int(gl_GlobalInvocationID.x);
  texel[v] = int(gl_GlobalInvocationID.y);
  if (texel[u] >= texels[u] || texel[v] >= texels[v]) return;
  ivec4 running[4] = ivec4[4](ivec4(0), ivec4(0), ivec4(0), ivec4(0));
  for (texel[axis] = 0; texel[axis] < texels[axis]; ++texel[axis]) {
    uint c = cell_index(ivec3(4 * texel.x, texel.yz), push.cells);
    uint word = bits[c >> 5];
    uint four = word >> (c & 31u) & 15u;  // never across words: rows are multiples of 4
    vec4 open;
    for (int k = 0; k < 4; ++k) {
      const int lane = axis == 0 ? 0 : k;
      open[k] = float(running[lane].x) / fixed_one;
      if ((four >> k & 1u) == 0u) continue;
      uint rank = rank_of(word, before[c >> 5], (c & 31u) + uint(k));
      ivec4 surface = faces[3u * rank + uint(axis)];
      faces[3u * rank + uint(axis)] = running[lane];
      running[lane] -= surface;
    }
    imageStore(aperture, texel, open);
  }
  int left = 0;
  for (int k = 0; k < (axis == 0 ? 1 : 4); ++k) left = max(left, abs(running[k].x));
  atomicMax(status.closure, uint(left));
}

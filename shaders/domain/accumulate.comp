// Clips the triangles to the cells and adds up the integrals over the pieces. One thread an item.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "sums.glsl"
#include "triangles.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { DomainPush push; };
layout(binding = 3, scalar) readonly buffer Bits { uint bits[]; };
layout(binding = 4, scalar) readonly buffer Before { uint before[]; };
layout(binding = 5, scalar) buffer Sums { int sums[]; };

vec3 polygon[10];
int corners;

// Keeps the part with sign * (x_axis - plane) <= 0. A cut point is always reckoned from the end that stays, so that the
// two triangles of an edge find the same one.
void clip(int axis, float plane, float sign) {
  vec3 kept[10];
  int n = 0;
  vec3 a = polygon[corners - 1];
  float da = sign * (a[axis] - plane);
  for (int c = 0; c < corners; ++c) {
    vec3 b = polygon[c];
    float db = sign * (b[axis] - plane);
    if ((da < 0.0 && db > 0.0) || (da > 0.0 && db < 0.0)) {
      vec3 inner = da < 0.0 ? a : b, outer = da < 0.0 ? b : a;
      float di = min(da, db), dout = max(da, db);
      vec3 p = inner + (outer - inner) * (di / (di - dout));
      p[axis] = plane;
      kept[n++] = p;
    }
    if (db <= 0.0) kept[n++] = b;
    a = b;
    da = db;
  }
  for (int c = 0; c < n; ++c) polygon[c] = kept[c];
  corners = n;
}

void add(uint at, float value) { atomicAdd(sums[at], int(round(value * fixed_one))); }

// Ties between axes go to the first, with some slack so that rounding does not decide.
int facet_class(vec3 normal) {
  vec3 size = abs(normal);
  int axis = size.x >= 0.9999 * size.y && size.x >= 0.9999 * size.z ? 0 : size.y >= 0.9999 * size.z ? 1 : 2;
  return 2 * axis + (normal[axis] < 0.0 ? 1 : 0);
}

void add_polygon(uint at, vec3 normal) {
  vec3 A = vec3(0), X = vec3(0), Q = vec3(0);
  mat3 M = mat3(0);
  float S = 0.0;
  vec3 a = polygon[0], b = polygon[1];
  for (int t = 2; t < corners; ++t) {
    vec3 c = polygon[t];
    vec3 dA = 0.5 * cross(b - a, c - a), centre = (a + b + c) / 3.0;
    float dS = dot(dA, normal);
    A += dA;
    S += dS;
    X += dS * centre;
    for (int i = 0; i < 3; ++i) M[i] += dA[i] * centre;
    Q += dA * (a * a + b * b + c * c + a * b + b * c + c * a) / 12.0;
    b = c;
  }
  for (int i = 0; i < 3; ++i) {
    add(at + sum_A + i, A[i]);
    add(at + sum_X + i, X[i]);
    add(at + sum_Q + i, Q[i]);
    for (int j = 0; j < 3; ++j) add(at + sum_M + 3 * i + j, M[i][j]);
  }
  add(at + sum_S, S);
}

void main() {
  uint thread = gl_GlobalInvocationID.x;
  if (thread >= push.count) return;
  Item item = items[thread];
  Triangle t = load_triangle(item.triangle);
  int kind = facet_class(t.normal);
  uint end = min(item.first + cells_an_item, uint(t.size.x * t.size.y * t.size.z));
  for (uint n = item.first; n < end; ++n) {
    ivec3 cell = box_cell(t, n);
    if (!plane_meets(t, cell)) continue;
    polygon[0] = t.a - vec3(cell);
    polygon[1] = t.b - vec3(cell);
    polygon[2] = t.c - vec3(cell);
    corners = 3;
    vec3 low = min(min(polygon[0], polygon[1]), polygon[2]), high = max(max(polygon[0], polygon[1]), polygon[2]);
    for (int axis = 0; axis < 3; ++axis) {
      if (corners > 0 && low[axis] < 0.0) clip(axis, 0.0, -1.0);
      if (corners > 0 && high[axis] > 1.0) clip(axis, 1.0, 1.0);
    }
    if (corners < 3) continue;
    uint c = cell_index(cell, push.cells);
    uint rank = rank_of(bits[c >> 5], before[c >> 5], c & 31u);
    add_polygon((6u * rank + uint(kind)) * sum_count, t.normal);
  }
}

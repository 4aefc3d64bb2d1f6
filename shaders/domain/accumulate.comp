// Clips a triangle to a cell and adds up the integrals over the piece. One thread a pair. The polygon stays in registers:
// no index depends on data, because indexed private arrays are slow on every device and slowest on lavapipe.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "sums.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { DomainPush push; };
layout(binding = 0, scalar) readonly buffer Positions { vec3 positions[]; };  // grid units, see grid_positions()
layout(binding = 1, scalar) readonly buffer Triangles { uvec3 triangles[]; };
layout(binding = 2, scalar) readonly buffer Pairs { uvec2 pairs[]; };  // triangle, cell
layout(binding = 3, scalar) readonly buffer Bits { uint bits[]; };
layout(binding = 4, scalar) readonly buffer Before { uint before[]; };
layout(binding = 5, scalar) buffer Sums { int sums[]; };

const int most = 9;  // corners of a triangle clipped by six planes
vec3 polygon[most];
int corners;

// Keeps the part below (sign 1) or above (-1) the plane where the coordinate picked by `axis` has a value. A cut point is always reckoned from the end that stays, so that the two
// triangles of an edge find the same one.
void clip(vec3 axis, float plane, float sign) {
  vec3 kept[most];
  vec3 a = polygon[0];
  [[unroll]] for (int i = 0; i < most; ++i) {
    kept[i] = vec3(0);
    if (i == corners - 1) a = polygon[i];
  }
  float da = sign * (dot(axis, a) - plane);
  int n = 0;
  [[unroll]] for (int i = 0; i < most; ++i) {
    vec3 b = polygon[i];
    float db = sign * (dot(axis, b) - plane);
    bool used = i < corners;
    bool cut = used && min(da, db) < 0.0 && max(da, db) > 0.0;
    bool keep = used && db <= 0.0;
    vec3 inner = da < 0.0 ? a : b, outer = da < 0.0 ? b : a;
    float di = min(da, db), d_outer = max(da, db);
    vec3 p = mix(inner + (outer - inner) * (di / (di - d_outer)), vec3(plane), greaterThan(axis, vec3(0)));
    int at_b = n + (cut ? 1 : 0);
    [[unroll]] for (int k = 0; k <= min(i + 2, most - 1); ++k) {
      if (cut && k == n) kept[k] = p;
      if (keep && k == at_b) kept[k] = b;
    }
    n = at_b + (keep ? 1 : 0);
    a = used ? b : a;
    da = used ? db : da;
  }
  [[unroll]] for (int i = 0; i < most; ++i) polygon[i] = kept[i];
  corners = n;
}

void add(uint at, float value) { atomicAdd(sums[at], int(round(value * fixed_one))); }

#include "domain/facet_class.glsl"

void add_polygon(uint at, vec3 normal) {
  vec3 A = vec3(0), X = vec3(0), Q = vec3(0);
  mat3 M = mat3(0);
  float S = 0.0;
  vec3 a = polygon[0];
  [[unroll]] for (int t = 2; t < most; ++t) {
    vec3 b = polygon[t - 1], c = polygon[t];
    vec3 dA = t < corners ? 0.5 * cross(b - a, c - a) : vec3(0), centre = (a + b + c) / 3.0;
    float dS = dot(dA, normal);
    A += dA;
    S += dS;
    X += dS * centre;
    [[unroll]] for (int i = 0; i < 3; ++i) M[i] += dA[i] * centre;
    Q += dA * (a * a + b * b + c * c + a * b + b * c + c * a) / 12.0;
  }
  [[unroll]] for (int i = 0; i < 3; ++i) {
    add(at + sum_A + i, A[i]);
    add(at + sum_X + i, X[i]);
    add(at + sum_Q + i, Q[i]);
    [[unroll]] for (int j = 0; j < 3; ++j) add(at + sum_M + 3 * i + j, M[i][j]);
  }
  add(at + sum_S, S);
}

void main() {
  uint thread = gl_GlobalInvocationID.x;
  if (thread >= push.count) return;
  uvec2 pair = pairs[thread];
  uvec3 t = triangles[pair.x];
  vec3 low = vec3(cell_at(pair.y, push.cells));
  polygon[0] = positions[t.x] - low;
  polygon[1] = positions[t.y] - low;
  polygon[2] = positions[t.z] - low;
  [[unroll]] for (int i = 3; i < most; ++i) polygon[i] = vec3(0);
  corners = 3;
  vec3 normal = normalize(cross(polygon[1] - polygon[0], polygon[2] - polygon[0]));
  // Only the planes that the triangle crosses: the loop runs as often as the busiest lane needs.
  vec3 least = min(min(polygon[0], polygon[1]), polygon[2]), largest = max(max(polygon[0], polygon[1]), polygon[2]);
  uint planes = 0u;
  [[unroll]] for (int i = 0; i < 3; ++i) {
    planes |= (least[i] < 0.0 ? 1u << (2 * i) : 0u) | (largest[i] > 1.0 ? 2u << (2 * i) : 0u);
  }
  for (; planes != 0u; planes &= planes - 1u) {
    int p = findLSB(planes);
    float high = float(p & 1);
    clip(vec3(equal(ivec3(0, 1, 2), ivec3(p / 2))), high, 2.0 * high - 1.0);
  }
  if (corners < 3) return;
  uint c = pair.y;
  uint rank = rank_of(bits[c >> 5], before[c >> 5], c & 31u);
  add_polygon((6u * rank + uint(facet_class(normal))) * sum_count, normal);
}

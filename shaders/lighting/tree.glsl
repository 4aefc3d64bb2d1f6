// What a ray meets first. Needs scalar block layout; takes bindings 0 and 1.
#include "shared/exchange.h"

layout(binding = 0, scalar) readonly buffer Boxes { TreeBox boxes[]; };
layout(binding = 1, scalar) readonly buffer TreeTriangles { TreeTriangle tree_triangles[]; };

// Distance along the ray, or `far`. Closed objects are met from outside only: a ray that starts just below their surface
// leaves it unhindered. (Moeller and Trumbore 1997.)
float triangle_distance(TreeTriangle t, vec3 from, vec3 way, float far) {
  const vec3 ab = t.b - t.a, ac = t.c - t.a, p = cross(way, ac), s = from - t.a, q = cross(s, ab);
  const float det = dot(ab, p);
  if (det == 0 || (det < 0 && (t.object & tree_closed) != 0)) return far;
  // A hair wider than it is, so that no ray slips between two triangles.
  const float u = dot(s, p) / det, v = dot(way, q) / det, d = dot(ac, q) / det, edge = -1e-6;
  return u >= edge && v >= edge && u + v <= 1 - edge && d > 0 && d < far ? d : far;
}

// A walk in preorder without a stack: where a box is met the left child 2 k comes next, else the node after the subtree,
// k + 1 without the right turns that end there (its trailing zeros).
LinkHit nearest_hit(vec3 from, vec3 way, TreeShape tree) {
  LinkHit hit = LinkHit(tree_nothing, 1e30);
  const vec3 inverse = 1 / mix(way, vec3(1e-20), lessThan(abs(way), vec3(1e-20)));
  uint node = 1;
  do {
    const vec3 a = (boxes[node].low - from) * inverse, b = (boxes[node].high - from) * inverse;
    const vec3 near = min(a, b), far = max(a, b);
    const float enter = max(max(near.x, near.y), max(near.z, 0));
    const float leave = min(min(far.x, far.y), min(far.z, hit.distance));
    const bool met = enter <= leave * 1.000001 && boxes[node].low.x <= boxes[node].high.x;
    if (met && node < tree.leaves) {
      node *= 2;
      continue;
    }
    if (met) {
      const uint first = tree.leaf_triangles * (node - tree.leaves);
      for (uint i = first; i < first + tree.leaf_triangles; ++i) {
        const float d = triangle_distance(tree_triangles[i], from, way, hit.distance);
        if (d < hit.distance) hit = LinkHit(i, d);
      }
    }
    ++node;
    node >>= findLSB(node);
  } while (node != 1);
  return hit;
}

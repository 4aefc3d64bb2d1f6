// A bounding volume hierarchy over all triangles of a scene, one layout for GLSL and C++. Made by lighting/ray_tree.h.
#ifndef ALABASTER_SHARED_RAY_TREE_H
#define ALABASTER_SHARED_RAY_TREE_H
#include "language.h"

ALABASTER_BEGIN_SHARED

// Both lie in images of four words a texel, row by row: lavapipe reads a texel in one go, and the words of a storage
// buffer one by one.
const uint ray_node_texels = 2, ray_triangle_texels = 3;
const uint ray_row_bits = 10;  // a row of the images holds 2^this nodes or triangles

// Nodes lie in depth-first order: below an inner node the next entry is its first child, so that a walk needs no stack.
struct RayNode {
  vec3 low;    // m
  uint link;   // inner: the node after all below it, taken where the ray misses the box; leaf: its first triangle
  vec3 high;   // m
  uint count;  // triangles of a leaf; 0: inner
};

struct RayTriangle {
  vec3 corner, edge1, edge2;  // m; counter-clockwise seen from outside
  uint object;                // in Scene::objects
  uint closed;                // 1: the surface of a solid, met from outside only
  uint unused;
};

const uint ray_missed = 0xffffffffu;

struct RayHit {
  float distance;  // m
  uint triangle;   // in the order of the leaves, or ray_missed
};

const float ray_box_slack = 1.0000004f;  // a box's far side is rounded up by this, so that no ray slips between two
const float ray_edge_slack = 1e-6f;      // and a triangle's edges outward by this share of it

// One over a component of a ray's direction, finite where that is 0.
SHARED_FN real ray_inverse(real d) { return real(1) / (abs(d) > real(1e-20) ? d : real(1e-20)); }

ALABASTER_END_SHARED

#endif

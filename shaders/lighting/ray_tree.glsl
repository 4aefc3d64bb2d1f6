// What a ray meets: the walk through the tree of lighting/ray_tree.h. Needs scalar block layout; takes bindings 11 and 12.
#include "shared/ray_tree.h"

layout(binding = 11, scalar) readonly buffer Nodes { RayNode nodes[]; };
layout(binding = 12, scalar) readonly buffer RayTriangles { RayTriangle ray_triangles[]; };

const uint ray_missed = 0xffffffffu;

struct RayHit {
  float distance;  // m
  uint triangle;   // of ray_triangles, or ray_missed
};

// The nearest triangle between `near` and `far`, m.
RayHit trace_ray(vec3 origin, vec3 direction, float near, float far) {
  const vec3 inverse = vec3(ray_inverse(direction.x), ray_inverse(direction.y), ray_inverse(direction.z));
  RayHit hit = RayHit(far, ray_missed);
  const uint end = nodes[0].count == 0 ? nodes[0].link : 1;
  for (uint at = 0; at < end;) {
    const RayNode node = nodes[at];
    const vec3 a = (node.low - origin) * inverse, b = (node.high - origin) * inverse;
    const vec3 in_ = min(a, b), out_ = max(a, b);
    const bool met = max(max(in_.x, in_.y), max(in_.z, near)) <=
                     min(min(out_.x, out_.y), min(out_.z, hit.distance)) * ray_box_slack;
    for (uint i = 0; met && i < node.count; ++i) {
      const RayTriangle t = ray_triangles[node.link + i];
      const vec3 p = cross(direction, t.edge2), from = origin - t.corner, q = cross(from, t.edge1);
      const float det = dot(t.edge1, p);
      if (t.closed != 0 ? det <= 0 : det == 0) continue;
      const float over = 1 / det;
      const float u = dot(from, p) * over, v = dot(direction, q) * over, s = dot(t.edge2, q) * over;
      if (min(min(u, v), 1 - u - v) >= -ray_edge_slack && s >= near && s < hit.distance)
        hit = RayHit(s, node.link + i);
    }
    at = met || node.count != 0 ? at + 1 : node.link;
  }
  return hit;
}

// What a ray meets: the walk through the tree of lighting/ray_tree.h. Takes bindings 11 and 12.
#include "shared/ray_tree.h"

layout(binding = 11, rgba32ui) uniform readonly uimage2D ray_nodes;
layout(binding = 12, rgba32ui) uniform readonly uimage2D ray_triangles;

ivec2 ray_texel(uint i, uint texels) {
  return ivec2(texels * (i & ((1u << ray_row_bits) - 1)), i >> ray_row_bits);
}

RayNode ray_node(uint i) {
  const ivec2 at = ray_texel(i, ray_node_texels);
  const uvec4 a = imageLoad(ray_nodes, at), b = imageLoad(ray_nodes, at + ivec2(1, 0));
  return RayNode(uintBitsToFloat(a.xyz), a.w, uintBitsToFloat(b.xyz), b.w);
}

RayTriangle ray_triangle(uint i) {
  const ivec2 at = ray_texel(i, ray_triangle_texels);
  const uvec4 a = imageLoad(ray_triangles, at), b = imageLoad(ray_triangles, at + ivec2(1, 0)),
              c = imageLoad(ray_triangles, at + ivec2(2, 0));
  return RayTriangle(uintBitsToFloat(a.xyz), uintBitsToFloat(uvec3(a.w, b.xy)), uintBitsToFloat(uvec3(b.zw, c.x)), c.y, c.z, 0);
}

// The nearest triangle between `near` and `far`, m. Closed ones are met from outside, or with `side` -1 from inside. The lanes of a
// CPU walk on to the next leaf each and test triangles together: no lane tests any while another is between leaves. (Lavapipe
// runs what is under an `if`, and once what is in a loop, whether or not a lane wants it; a `do` spares that, but what goes on from
// turn to turn and out of it must be scalars, or lanes that have ended lose it.)
RayHit trace_side(vec3 origin, vec3 direction, float near, float far, float side) {
  const vec3 inverse = vec3(ray_inverse(direction.x), ray_inverse(direction.y), ray_inverse(direction.z));
  RayHit hit = RayHit(far, ray_missed);
  const RayNode root = ray_node(0);
  const uint end = root.count == 0 ? root.link : 1;
  uint at = 0;
  do {
    uint first = 0, count = 0;
    do {
      const RayNode node = ray_node(at);
      const vec3 a = (node.low - origin) * inverse, b = (node.high - origin) * inverse;
      const vec3 in_ = min(a, b), out_ = max(a, b);
      const bool met = max(max(in_.x, in_.y), max(in_.z, near)) <=
                       min(min(out_.x, out_.y), min(out_.z, hit.distance)) * ray_box_slack;
      if (met && node.count != 0) {
        first = node.link;
        count = node.count;
      }
      at = met || node.count != 0 ? at + 1 : node.link;
    } while (count == 0 && at < end);
    uint i = 0;
    do {
      const RayTriangle t = ray_triangle(first + i);
      const vec3 p = cross(direction, t.edge2), from = origin - t.corner, q = cross(from, t.edge1);
      const float det = dot(t.edge1, p);
      const float over = 1 / det;
      const float u = dot(from, p) * over, v = dot(direction, q) * over, s = dot(t.edge2, q) * over;
      const bool faces = t.closed != 0 ? side * det > 0 : det != 0;
      if (i < count && faces && min(min(u, v), 1 - u - v) >= -ray_edge_slack && s >= near && s < hit.distance)
        hit = RayHit(s, first + i);
    } while (++i < count);
  } while (at < end);
  return hit;
}

RayHit trace_ray(vec3 origin, vec3 direction, float near, float far) { return trace_side(origin, direction, near, far, 1); }

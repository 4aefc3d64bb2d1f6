// Where a straight way leaves the mesh: in a crease, or where parts of a cell's surface look different ways, its facet lies on none
// of it. Before: way.glsl, a GRID with its origin and lighting/ray_tree.glsl.
struct End {
  float at;  // h; `nowhere` where the mesh is not met
  vec3 normal;
};

// Between `near` and `far`, h: most ways are spent long before they leave, and a short ray meets little of the tree.
End mesh_end(vec3 from, vec3 along, float near, float far) {
  const RayHit hit = trace_side(GRID.origin + GRID.h * from, along, GRID.h * near, GRID.h * far, -1);
  if (hit.triangle == ray_missed) return End(nowhere, along);
  const RayTriangle met = ray_triangle(hit.triangle);
  return End(hit.distance / GRID.h, normalize(cross(met.edge1, met.edge2)));
}

// How far a way may go that spends itself at `depth` in matter like that of its first cell, h.
float likely_reach(Way w, float depth) {
  const Solid s = solid_at(w.cell);
  const float least = GRID.channels == 1 ? s.sigma_t.r : min(s.sigma_t.r, min(s.sigma_t.g, s.sigma_t.b));
  return 2 + (s.there ? depth / max(least, 1e-6) : 8);
}

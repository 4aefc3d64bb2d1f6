// Where a straight way leaves the mesh: in a crease, or where parts of a cell's surface look different ways, its facet lies on none
// of it. Before: way.glsl, a GRID with its origin and lighting/ray_tree.glsl.
struct End {
  float at;  // h; `nowhere` where the mesh is not met
  vec3 normal;
};

End mesh_end(vec3 from, vec3 along) {
  const float reach = GRID.h * float(GRID.cells.x + GRID.cells.y + GRID.cells.z);
  const RayHit hit = trace_side(GRID.origin + GRID.h * from, along, 0, reach, -1);
  if (hit.triangle == ray_missed) return End(nowhere, along);
  const RayTriangle met = ray_triangle(hit.triangle);
  return End(hit.distance / GRID.h, normalize(cross(met.edge1, met.edge2)));
}

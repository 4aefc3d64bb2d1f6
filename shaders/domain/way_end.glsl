// Whether a way that leaves by a facet at `end` (h) goes on inside. In a crease a facet is the mean of all the surface in its cell
// and lies on none of it: where the mesh does not end within a cell of there, the way does not, either. Elsewhere facets are
// the ends, as in the beams' march: so what is seen and what beams bring are one. Before: way.glsl, a GRID with its origin and
// lighting/ray_tree.glsl.
bool mesh_goes_on(Way w, float end) {
  const RayHit hit = trace_side(GRID.origin + GRID.h * w.from, w.along, GRID.h * max(end - 1, 0), GRID.h * (end + 1), -1);
  return hit.triangle == ray_missed;
}

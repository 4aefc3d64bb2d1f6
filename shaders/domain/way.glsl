// Straight ways through the cells of an object. Before: the domain's cut_index, cut_cells and volume, the solver's kappa and
// absorption, and a GRID with cells, channels, h and kappa_scale.
const float nowhere = 1e30;

struct Solid {
  bool there;
  vec3 sigma_t;  // 1/h
  vec3 albedo;
};

Solid solid_at(ivec3 c) {
  Solid s = Solid(false, vec3(0), vec3(0));
  const bool in_grid = all(greaterThanEqual(c, ivec3(0))) && all(lessThan(c, GRID.cells));
  if (!in_grid || imageLoad(volume, ivec3(c.x >> 2, c.yz))[c.x & 3] <= 0) return s;
  s.there = true;
  for (int k = 0; k < GRID.channels; ++k) {
    const ivec3 t = ivec3(c.x >> 2, c.y, c.z + k * GRID.cells.z);
    const float kap = max(imageLoad(kappa, t)[c.x & 3] * GRID.kappa_scale[k], 1e-30);
    const float sigma_a = imageLoad(absorption, t)[c.x & 3] * GRID.kappa_scale[k] / (GRID.h * GRID.h);
    s.sigma_t[k] = GRID.h / (3 * kap);
    s.albedo[k] = clamp(1 - 3 * kap * sigma_a, 0, 1);
  }
  return s;
}

// A straight way through the cells.
struct Way {
  vec3 from, along;  // h, from the grid's corner; unit
  ivec3 cell, step_;
  vec3 next, each;   // distance to the next cell, between cells, along each axis
  float at;          // distance
};

Way way_from(vec3 from, vec3 along, ivec3 cell) {
  Way w;
  w.from = from;
  w.along = along;
  w.cell = cell;
  w.step_ = ivec3(sign(along));
  w.at = 0;
  for (int a = 0; a < 3; ++a) {
    const bool moves = abs(along[a]) > 1e-9;
    w.each[a] = moves ? 1 / abs(along[a]) : nowhere;
    w.next[a] = moves ? max(0, (float(cell[a] + (along[a] > 0 ? 1 : 0)) - from[a]) / along[a]) : nowhere;
  }
  return w;
}

float cell_end(Way w) { return min(w.next.x, min(w.next.y, w.next.z)); }

void step_on(inout Way w) {
  const int a = w.next.x <= w.next.y && w.next.x <= w.next.z ? 0 : w.next.y <= w.next.z ? 1 : 2;
  w.at = max(w.at, w.next[a]);
  w.cell[a] += w.step_[a];
  w.next[a] += w.each[a];
}

// Where the way leaves the object within its cell, through which normal; `nowhere` if it does not.
float leaves_at(Way w, uint index, float end, out vec3 normal) {
  float first = nowhere;
  normal = vec3(0);
  for (int s = 0; s < 2 && index != 0; ++s) {
    const GpuFacet side = cut_cells[index].side[s];
    const float size = length(side.area_vector);
    if (side.area <= 0 || size <= 0.5 * side.area) continue;
    const vec3 n = side.area_vector / size;
    const float rate = dot(n, w.along), off = dot(n, w.from - vec3(w.cell) - side.centre);
    if (rate <= 1e-6 || off + rate * end <= 1e-4) continue;
    const float t = max(w.at, -off / rate);
    if (t < first) {
      first = t;
      normal = n;
    }
  }
  return first;
}

// Work items: a triangle and up to 64 cells of its bounding box. They are listed by the host, so that huge and tiny
// triangles are shared out evenly.
struct Item {
  uint triangle;
  uint first;  // cell of the box, x fastest
};
const int cells_an_item = 64;

layout(binding = 0, scalar) readonly buffer Positions { vec3 positions[]; };  // grid units, see grid_positions()
layout(binding = 1, scalar) readonly buffer Triangles { uvec3 triangles[]; };
layout(binding = 2, scalar) readonly buffer Items { Item items[]; };

struct Triangle {
  vec3 a, b, c;
  vec3 normal;  // unit
  ivec3 low, size;  // of its box of cells
};

// A triangle that lies in a grid plane belongs to the cell on its inner side.
Triangle load_triangle(uint index) {
  uvec3 t = triangles[index];
  Triangle r;
  r.a = positions[t.x];
  r.b = positions[t.y];
  r.c = positions[t.z];
  vec3 n = cross(r.b - r.a, r.c - r.a);
  float size = length(n);
  r.normal = size > 0.0 ? n / size : vec3(0);
  vec3 low = min(min(r.a, r.b), r.c), high = max(max(r.a, r.b), r.c);
  r.low = ivec3(floor(low));
  ivec3 top = ivec3(ceil(high));
  for (int i = 0; i < 3; ++i) {
    if (low[i] == high[i] && low[i] == floor(low[i])) {
      r.low[i] = int(low[i]) - (n[i] > 0.0 ? 1 : 0);
      top[i] = r.low[i] + 1;
    }
  }
  r.size = size > 0.0 ? top - r.low : ivec3(0);
  return r;
}

ivec3 box_cell(Triangle t, uint number) {
  int n = int(number);
  return t.low + ivec3(n % t.size.x, n / t.size.x % t.size.y, n / (t.size.x * t.size.y));
}

// Whether the triangle's plane meets the cell (with a little to spare).
bool plane_meets(Triangle t, ivec3 cell) {
  float d = dot(t.normal, vec3(cell) + 0.5 - t.a);
  return abs(d) <= 0.5 * dot(abs(t.normal), vec3(1)) + 1e-4;
}

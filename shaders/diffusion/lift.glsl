// By how much the four cells of a texel are lifted: islands.comp.
layout(binding = 3, scalar) readonly buffer Labels { uvec4 labels[]; };  // [channel][z][y][texel]
layout(binding = 4, scalar) readonly buffer Lifts { float lifts[]; };

vec4 lift_at(ivec3 t) {
  int nx4 = texels(push.cells.x);
  bool in_grid = t.x < nx4 && t.y < push.cells.y;  // tiles reach beyond it
  uvec4 label = labels[in_grid ? t.x + nx4 * (t.y + push.cells.y * t.z) : 0];
  return vec4(lifts[label.x], lifts[label.y], lifts[label.z], lifts[label.w]);
}

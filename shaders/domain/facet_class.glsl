// Parts the surface in a cell in six by its normal: 2 * (nearest axis) + (1 where it points down that axis). The parity is the
// facet's side, so that the two sheets of a thin part stay apart. Ties between axes go to the first, with some slack so
// that rounding does not decide. Twin: engine/domain/cut_cells.h.
int facet_class(vec3 normal) {
  vec3 size = abs(normal);
  int axis = size.x >= 0.9999 * size.y && size.x >= 0.9999 * size.z ? 0 : size.y >= 0.9999 * size.z ? 1 : 2;
  return 2 * axis + (normal[axis] < 0.0 ? 1 : 0);
}

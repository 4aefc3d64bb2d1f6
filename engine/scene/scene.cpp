#include "scene/scene.h"

#include <algorithm>

namespace alabaster {

Bounds bounds_of(const Mesh& mesh) {
  Bounds bounds;
  for (glm::uvec3 t : mesh.triangles)
    for (int corner = 0; corner < 3; ++corner) bounds.add(mesh.positions[t[corner]]);
  return bounds;
}

glm::dvec3 Grid::at(glm::ivec3 cell) const {
  glm::ivec3 c = glm::clamp(cell, glm::ivec3(0), size - 1);
  std::size_t index = channels * (c.x + std::size_t(size.x) * (c.y + std::size_t(size.y) * c.z));
  if (channels == 1) return glm::dvec3(values[index]);
  return {values[index], values[index + 1], values[index + 2]};
}

glm::dvec3 Grid::sample(glm::dvec3 unit_cube) const {
  // Far outside the box the integer cell would overflow; clamping first changes nothing, as the nearest cell holds
  // there.
  glm::dvec3 p = glm::clamp(unit_cube, 0.0, 1.0) * glm::dvec3(size);
  if (!trilinear) return at(glm::ivec3(glm::floor(p)));
  p -= 0.5;
  glm::ivec3 low(glm::floor(p));
  glm::dvec3 f = p - glm::dvec3(low);
  std::size_t offset[3][2];  // of the cells below and above along each axis, in values
  const std::size_t stride[3] = {std::size_t(channels), std::size_t(channels) * size.x,
                                 std::size_t(channels) * size.x * size.y};
  for (int axis = 0; axis < 3; ++axis)
    for (int up = 0; up < 2; ++up) offset[axis][up] = stride[axis] * std::clamp(low[axis] + up, 0, size[axis] - 1);
  glm::dvec3 sum(0);
  for (int corner = 0; corner < 8; ++corner) {
    const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
    const double weight = (x ? f.x : 1 - f.x) * (y ? f.y : 1 - f.y) * (z ? f.z : 1 - f.z);
    const float* value = &values[offset[0][x] + offset[1][y] + offset[2][z]];
    sum += weight * (channels == 1 ? glm::dvec3(value[0]) : glm::dvec3(value[0], value[1], value[2]));
  }
  return sum;
}

Coefficients Medium::at(glm::dvec3 world) const {
  if (!heterogeneous()) return homogeneous;
  glm::dvec3 p(world_to_box * glm::dvec4(world, 1));
  glm::dvec3 extinction = scale * sigma_t->sample(p);
  glm::dvec3 a = albedo->sample(p);
  return {extinction * a, extinction * (1.0 - a)};
}

glm::dvec3 Medium::majorant() const {
  if (!heterogeneous()) return homogeneous.sigma_s + homogeneous.sigma_a;
  glm::dvec3 largest(0);
  for (std::size_t i = 0; i < sigma_t->values.size(); i += sigma_t->channels) {
    const float* cell = &sigma_t->values[i];
    largest = glm::max(largest, sigma_t->channels == 1 ? glm::dvec3(cell[0]) : glm::dvec3(cell[0], cell[1], cell[2]));
  }
  return scale * largest;
}

}  // namespace alabaster

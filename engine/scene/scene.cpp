#include "scene/scene.h"

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
  glm::dvec3 sum(0);
  for (int corner = 0; corner < 8; ++corner) {
    glm::ivec3 step(corner & 1, corner >> 1 & 1, corner >> 2);
    double weight = 1;
    for (int axis = 0; axis < 3; ++axis) weight *= step[axis] ? f[axis] : 1 - f[axis];
    sum += weight * at(low + step);
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

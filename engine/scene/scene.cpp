#include "scene/scene.h"

#include <algorithm>

#include "scene/procedural.h"

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

bool Medium::grey() const {
  const auto grey = [](glm::dvec3 c) { return c.r == c.g && c.g == c.b; };
  if (solid) {
    for (const SolidPart& part : solid->parts)
      if (!grey(part.sigma_s) || !grey(part.sigma_a)) return false;
    return true;
  }
  for (const auto& grid : {sigma_t, albedo, sigma_s, sigma_a})
    if (grid && grid->channels > 1) return false;
  return gridded() || (grey(homogeneous.sigma_s) && grey(homogeneous.sigma_a));
}

Coefficients Medium::at(glm::dvec3 world) const {
  if (!heterogeneous()) return homogeneous;
  const glm::dvec3 p(world_to_box * glm::dvec4(world, 1));
  if (solid) {
    const double below = depth ? depth->sample(glm::dvec3(world_to_depth * glm::dvec4(world, 1))).x : 0;
    const SolidCoefficients<double> c = solid_at<double>(*solid, p, below);
    return {c.sigma_s, c.sigma_a};
  }
  if (sigma_s) return {scale * sigma_s->sample(p), scale * sigma_a->sample(p)};
  const glm::dvec3 extinction = scale * sigma_t->sample(p), a = albedo->sample(p);
  return {extinction * a, extinction * (1.0 - a)};
}

glm::dvec3 Grid::largest() const {
  glm::dvec3 most(0);
  for (std::size_t i = 0; i < values.size(); i += channels)
    most = glm::max(most, channels == 1 ? glm::dvec3(values[i]) : glm::dvec3(values[i], values[i + 1], values[i + 2]));
  return most;
}

glm::dvec3 Medium::majorant() const {
  if (solid) {
    glm::dvec3 most(0);
    for (const SolidPart& part : solid->parts)
      most = glm::max(most, glm::dvec3(part.sigma_s) + glm::dvec3(part.sigma_a));
    return most;
  }
  if (sigma_s) return scale * (sigma_s->largest() + sigma_a->largest());
  return sigma_t ? scale * sigma_t->largest() : homogeneous.sigma_s + homogeneous.sigma_a;
}

double Medium::feature_size() const {
  const glm::dmat3 box(glm::inverse(world_to_box));
  const double unit = std::min({glm::length(box[0]), glm::length(box[1]), glm::length(box[2])});
  if (solid && solid->kind == solid_skin) return std::min(solid->depths.x, solid->depths.y - solid->depths.x);
  if (solid) return unit * solid_feature(*solid);
  double voxel = INFINITY;
  for (const auto& grid : {sigma_t, albedo, sigma_s, sigma_a})
    for (int axis = 0; axis < 3 && grid; ++axis)
      voxel = std::min(voxel, glm::length(box[axis]) / grid->size[axis] * (grid->trilinear ? 2 : 1));
  return voxel;
}

}  // namespace alabaster

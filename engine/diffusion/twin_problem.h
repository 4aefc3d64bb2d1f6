// The discrete diffusion problem of one channel on cut cells, in double precision: twin of
// shaders/diffusion/operator.comp.
#pragma once

#include <functional>

#include "diffusion/twin.h"
#include "domain/cut_cells.h"

namespace alabaster::twin {

/// A medium of one channel.
struct Material {
  double kappa = 0;    // m
  double sigma_a = 0;  // 1/m
};
using MaterialField = std::function<Material(glm::dvec3 world)>;

/// Finite volumes with unknowns at the cells' centroids,
///   sum_f T_f (phi_i - phi_j) + sigma_a V phi_i + B_i (phi_i - q_i) = 0,
/// divided by h * kappa_scale: T_f = aperture / (d_i / k_i + d_j / k_j), k = kappa / kappa_scale, distances in h;
/// B_i = sum over the two sides of its surface of area / (2 A kappa_scale / h + d / k).
struct Problem {
  Operator a;
  Vector facet_conductance;  // B_i, per cell
  Vector absorption;         // sigma_a V h^2 / kappa_scale, per cell
  Vector kappa;              // m, per cell
  double kappa_scale = 1;    // m: the largest kappa
};

/// Distances below this (in h) count as this: a sliver's unknown may not be glued to its neighbour without bound.
inline constexpr double least_distance = 0.05;

Problem assemble(const CutCells& cells, const MaterialField& medium, double A);

/// World position of a cell's unknown, m.
glm::dvec3 unknown_position(const CutCells& cells, glm::ivec3 cell);

}  // namespace alabaster::twin

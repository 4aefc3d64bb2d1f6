#include "diffusion/twin_problem.h"

#include <algorithm>

#include "shared/optics.h"

namespace alabaster::twin {
namespace {

template <typename F>
void for_active(const CutCells& cells, F f) {
  for (int z = 0; z < cells.frame.cells.z; ++z)
    for (int y = 0; y < cells.frame.cells.y; ++y)
      for (int x = 0; x < cells.frame.cells.x; ++x)
        if (cells.volume[cells.index({x, y, z})] > 0) f(glm::ivec3(x, y, z));
}

}  // namespace

glm::dvec3 unknown_position(const CutCells& cells, glm::ivec3 cell) {
  return glm::dvec3(cells.frame.origin) + double(cells.frame.h) * (glm::dvec3(cell) + cells.centroid(cell));
}

Problem assemble(const CutCells& cells, const MaterialField& medium, double A) {
  Problem problem;
  const glm::ivec3 n = cells.frame.cells;
  const double h = cells.frame.h;
  problem.a = Operator::seven_point(n);
  const Lattice& grid = problem.a.grid;
  for (Vector* v : {&problem.facet_conductance, &problem.absorption, &problem.kappa}) v->assign(grid.size(), 0.0);
  problem.kappa_scale = 0;
  for_active(cells, [&](glm::ivec3 c) {
    const Material m = medium(unknown_position(cells, c));
    problem.kappa[grid.at(c)] = m.kappa;
    problem.absorption[grid.at(c)] = m.sigma_a * h * h * cells.volume[cells.index(c)];
    problem.kappa_scale = std::max(problem.kappa_scale, m.kappa);
  });
  Vector& diagonal_entry = problem.a.a[diagonal];
  for_active(cells, [&](glm::ivec3 c) {
    const std::ptrdiff_t i = grid.at(c);
    const double k = problem.kappa[i] / problem.kappa_scale;
    for (int axis = 0; axis < 3; ++axis) {
      glm::ivec3 below = c;
      --below[axis];
      const double aperture = cells.aperture[axis][cells.index(c)];
      const std::ptrdiff_t j = grid.at(below);
      if (aperture <= 0 || problem.kappa[j] <= 0) continue;
      const double own = std::max(cells.centroid(c)[axis], least_distance);
      const double other = std::max(1 - cells.centroid(below)[axis], least_distance);
      const double conductance = aperture / (own / k + other * problem.kappa_scale / problem.kappa[j]);
      problem.a.a[low_face[axis]][i] = -conductance;
      diagonal_entry[i] += conductance;
      diagonal_entry[j] += conductance;
    }
    problem.absorption[i] /= problem.kappa_scale;
    if (const CutCell* cut = cells.find(c)) {
      for (const Facet& side : cut->side) {
        const double depth = std::max(side.distance, least_distance) / k;
        problem.facet_conductance[i] += side.area * dsbc_conductance(A * problem.kappa_scale / h, depth);
      }
    }
    diagonal_entry[i] += problem.absorption[i] + problem.facet_conductance[i];
  });
  return problem;
}

}  // namespace alabaster::twin

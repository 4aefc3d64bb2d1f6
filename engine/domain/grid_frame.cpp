#include "domain/grid_frame.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "scene/error.h"

namespace alabaster {

namespace {

constexpr double margin = 1.25;  // cells

}  // namespace

GridFrame choose_frame(const Bounds& bounds, int cells_along_longest, int alignment_x) {
  if (cells_along_longest < smallest_grid || cells_along_longest > largest_grid) {
    throw UserError("grid: " + std::to_string(cells_along_longest) + " cells asked for; choose " +
                    std::to_string(smallest_grid) + " to " + std::to_string(largest_grid));
  }
  glm::dvec3 size = glm::dvec3(bounds.high) - glm::dvec3(bounds.low);
  double longest = std::max({size.x, size.y, size.z});
  if (!std::isfinite(size.x + size.y + size.z) || longest <= 0) {
    throw UserError("grid: the object has no extent, or a vertex is not finite; mend the mesh");
  }
  GridFrame frame;
  frame.h = float(longest / (cells_along_longest - 2 * margin));
  glm::dvec3 needed = glm::ceil(size / double(frame.h) + 2 * margin - 1e-3);
  frame.cells = glm::max(glm::ivec3(needed), glm::ivec3(4));
  frame.cells.x = (frame.cells.x + alignment_x - 1) / alignment_x * alignment_x;
  glm::dvec3 centre = 0.5 * (glm::dvec3(bounds.low) + glm::dvec3(bounds.high));
  frame.origin = glm::vec3(centre - 0.5 * double(frame.h) * glm::dvec3(frame.cells));
  return frame;
}

float lattice_step(const GridFrame& frame) {
  int bits = 0;
  while ((1 << bits) < std::max({frame.cells.x, frame.cells.y, frame.cells.z})) ++bits;
  return std::ldexp(1.0f, bits - 23);
}

std::vector<glm::vec3> grid_positions(const Mesh& mesh, const GridFrame& frame) {
  double step = lattice_step(frame);
  std::vector<glm::vec3> positions;
  positions.reserve(mesh.positions.size());
  for (glm::vec3 p : mesh.positions) {
    glm::dvec3 q = (glm::dvec3(p) - glm::dvec3(frame.origin)) / double(frame.h);
    q = glm::round(q / step) * step;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(q[axis] >= 1 && q[axis] <= frame.cells[axis] - 1)) {
        throw UserError(
            "grid: a vertex of the mesh lies outside the frame or is not finite; make the frame from the mesh's "
            "bounds");
      }
    }
    positions.push_back(glm::vec3(q));
  }
  return positions;
}

}  // namespace alabaster

// How deep below a closed surface a point is.
#pragma once

#include <memory>

#include "scene/scene.h"

namespace alabaster {

struct DepthGrid {
  std::shared_ptr<const Grid> grid;  // m, positive inside; bounded to about the `deepest` that was asked for
  glm::dmat4 world_to_box{1.0};      // world position -> the grid's unit cube
};

/// Signed distances to `mesh` (closed, wound outwards, welded), exact at the points of a grid of 96 along its longest
/// edge and trilinear between: exact where the surface is flat, rounded over a cell at edges and creases. The sign is
/// that of the angle-weighted pseudonormal at the closest point (J. A. Baerentzen, H. Aanaes, "Signed Distance
/// Computation Using the Angle Weighted Pseudonormal", 2005).
DepthGrid measure_depth(const Mesh& mesh, double deepest);

/// Gives the medium of an object its depth grid where it is layered skin.
void add_depth(Object& object);

}  // namespace alabaster

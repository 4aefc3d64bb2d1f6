// Makes sure that a translucent mesh bounds a solid.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"

namespace alabaster {

/// `mesh` as the boundary of a solid: welded, without degenerate or double triangles, closed, manifold or even along
/// every edge, consistently wound, outwards around each component; a component inside another one is a cavity. Its area
/// vectors add up to zero. Small holes (at most 64 edges, together at most 2 % of the area) are filled by a fan around
/// their centre. What was repaired goes to `warnings`. Self-intersections are neither looked for nor mended.
/// `name` and `file` go into the messages.
/// Throws UserError where the mesh bounds no solid: larger holes (says where they are), edges with an odd number of
/// triangles, one-sided (Moebius) surfaces, no volume.
Mesh checked_solid(const Mesh& mesh, const std::string& name, const std::string& file,
                   std::vector<std::string>& warnings);

}  // namespace alabaster

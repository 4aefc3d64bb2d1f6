// Vertices and triangles that say the same thing twice.
#pragma once

#include "scene/scene.h"

namespace alabaster {

/// One vertex for all that lie at the same place (glTF splits vertices by normal and texture coordinate) or, with a
/// tolerance, nearer than that to one seen before (m). Vertices of no triangle go.
Mesh welded(const Mesh& mesh, float tolerance = 0);

/// Removes triangles with a corner used twice; returns how many. The mesh stays as closed as it was.
std::size_t drop_degenerate(Mesh& mesh);

/// Keeps one of the triangles that join the same three vertices, whichever way round; returns how many went.
std::size_t drop_duplicates(Mesh& mesh);

/// Flips the longest edge of triangles whose height is below 1e-6 of their length: the needle goes, the surface does
/// not move. `mesh` must be closed and consistently wound. Returns how many needles are gone.
std::size_t flip_needles(Mesh& mesh);

}  // namespace alabaster

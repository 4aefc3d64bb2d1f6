// Whether a mesh can see itself.
#pragma once

#include "scene/scene.h"

namespace alabaster {

/// True for a closed mesh in one piece that bends towards its inside, or not at all, at every edge (to a millionth of
/// its size): no part of it sees another.
bool is_convex(const Mesh& mesh);

}  // namespace alabaster

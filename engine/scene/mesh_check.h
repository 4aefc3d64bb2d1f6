// Makes sure that a translucent mesh bounds a solid.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"

namespace alabaster {

/// `mesh` welded, closed and wound outwards, so that its area vectors add up to zero. `name` and `file` go into
/// messages. Throws UserError where it bounds no solid.
Mesh checked_solid(Mesh mesh, const std::string& name, const std::string& file, std::vector<std::string>& warnings);

}  // namespace alabaster

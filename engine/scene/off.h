#pragma once

#include <string>

#include "scene/scene.h"

namespace alabaster {

/// Reads a mesh in the Object File Format (text, "OFF"; polygons are cut into fans). Throws UserError when the file is
/// missing, truncated, or has an index out of range or a coordinate that is not finite.
Mesh read_off(const std::string& path);

}  // namespace alabaster

// Mitsuba's .vol grids, format version 3, 32-bit floats: "VOL", 3, then little-endian int32 encoding (1), size x, y, z,
// channels, six floats of bounding box, and the values (x fastest, channels innermost).
#pragma once

#include <string>

#include "scene/scene.h"

namespace alabaster {

/// Reads a grid of 1 or 3 channels; the file's own bounding box is not used (a scene says where its grids lie).
/// Throws UserError when the file is missing, truncated, too long, of another kind, or holds values that are not
/// finite.
Grid read_vol(const std::string& path);

/// Writes `grid` with the unit cube as its box; whole or not at all. Throws UserError when it cannot.
void write_vol(const Grid& grid, const std::string& path);

}  // namespace alabaster

// Media from OpenVDB files.
#pragma once

#include "scene/fields.h"
#include "scene/scene.h"

namespace alabaster {

/// An extras.medium of type "vdb": {"file": "smoke.vdb"}, beside the scene, with either the six grids sigma_s.r ...
/// sigma_a.b in 1/m, or "density": the name of one grid, and "sigma_s", "sigma_a" (1/m) that it multiplies. "filter",
/// "scale" and "g" as in a medium of .vol grids. Voxels lie where the file's transform (affine) puts them in the
/// object's frame, or, with "bbox_min" and "bbox_max", fill that box; beyond the active voxels the nearest one of their
/// box holds, and inactive ones have the grid's background.
/// Throws UserError for a file that is missing, damaged, too large (more than 2^26 voxels in the box of the active
/// ones), has no such grids, or grids that are no floats, are negative, not finite or not aligned.
Medium read_vdb_medium(const Fields& medium);

}  // namespace alabaster

#pragma once

#include <string>

#include "scene/scene.h"

namespace alabaster {

/// Writes `scene` as glTF 2.0 binary (.glb): one node, mesh and material an object, in world space; cameras; the
/// punctual lights; the environment and media in extras, their grids as .vol files beside it ("NAME-0.vol", ...).
/// load_scene() reads it back. Throws UserError where a file cannot be written, std::invalid_argument for a grid box
/// that is not along the axes.
void write_gltf(const Scene& scene, const std::string& path);

}  // namespace alabaster

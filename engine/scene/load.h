#pragma once

#include <string>

#include "scene/scene.h"

namespace alabaster {

/// Reads a glTF 2.0 scene (.gltf with files or data URIs beside it, or .glb) in metres: every mesh of the scene's nodes
/// in world space, perspective cameras and the constant environment. Translucent meshes come out closed and wound
/// outwards (mesh_check.h). What was repaired or ignored stands in Scene::warnings. Throws UserError, one line with
/// file, field and remedy, for anything that cannot be rendered: an unreadable or malformed file, values that are not
/// finite or out of range, missing .vol files, meshes with large holes, a scene without triangles, camera or light.
Scene load_scene(const std::string& path);

}  // namespace alabaster

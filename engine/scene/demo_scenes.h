// The scenes of the demo and of the studies: an object 0.1 m tall on the ground, lamps, a camera that frames it.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"

namespace alabaster {

/// Every named scene. Besides these demo_scene() knows "MESH-Nmfp-ALBEDO-ETA" ("bunny-50mfp-0.99-1.3"): a grey
/// homogeneous medium, g = 0, whose object is N mean free paths tall.
std::vector<std::string> demo_scene_names();

/// One scene by name. Scanned meshes come as OFF files from `mesh_folder` (third_party/fetch-meshes); they are checked
/// and repaired as load_scene() does, see Scene::warnings.
/// Throws UserError for an unknown name or a mesh that is missing.
Scene demo_scene(const std::string& name, const std::string& mesh_folder);

/// Whether that scene's brightest lamp stands behind the object. False for an unknown name.
bool lit_from_behind(const std::string& name);

}  // namespace alabaster

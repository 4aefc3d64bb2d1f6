// glTF accessors -> triangles.
#pragma once

#include <tiny_gltf.h>

#include <string>
#include <vector>

#include "scene/scene.h"

namespace alabaster {

/// The triangles of one primitive (list, strip or fan) in its own frame; empty for points and lines.
/// `place` ("file: mesh 'x'") begins every error. Throws UserError where an index points outside, a buffer is too
/// short, a position is not finite, or the encoding is one that is not read (sparse, quantised, compressed).
Mesh read_primitive(const tinygltf::Model& model, const tinygltf::Primitive& primitive, const std::string& place);

/// TEXCOORD_`set`, one a vertex; empty where the primitive has none. Throws UserError as above, and for numbers that
/// are not 32-bit floats.
std::vector<glm::vec2> read_texcoords(const tinygltf::Model& model, const tinygltf::Primitive& primitive, int set,
                                      const std::string& place);

}  // namespace alabaster

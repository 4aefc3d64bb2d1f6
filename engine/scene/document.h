// A glTF file, read but not yet understood.
#pragma once

#include <tiny_gltf.h>

#include <string>

#include "scene/error.h"
#include "scene/fields.h"

namespace alabaster {

/// A glTF file twice over: tinygltf's model for meshes and buffers, and its JSON for what tinygltf does not know.
struct Document {
  std::string path;
  tinygltf::Model model;
  nlohmann::json root;

  Fields fields(const std::string& list, int index, const std::string& name) const {
    nlohmann::json object = root.contains(list) ? root[list].at(index) : nlohmann::json::object();
    return Fields(object, path, name + " ");
  }
};

/// Throws UserError for a file that is empty, too large, not glTF 2.0, nested without end, or that requires an
/// extension which is not read.
Document open_document(const std::string& path);

/// What is thrown for a file whose JSON is not glTF; `why` is a reader's own message, of any number of lines.
UserError unreadable(const std::string& path, std::string why, const std::string& remedy = "export it again");

}  // namespace alabaster

#include "scene/document.h"

#include <cstring>
#include <filesystem>
#include <set>

#include "scene/files.h"

namespace alabaster {
namespace {

const std::set<std::string> extensions_read = {
    "KHR_materials_ior",      "KHR_materials_volume",       "KHR_materials_volume_scatter",
    "KHR_materials_scatter",  "KHR_materials_transmission", "KHR_materials_emissive_strength",
    "KHR_materials_specular", "KHR_lights_punctual",        "KHR_materials_diffuse_transmission"};

/// The readers of JSON call themselves once a level: refuse what would use up the stack.
void check_nesting(const std::string& bytes, const std::string& path) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    char c = bytes[i];
    if (quoted && c == '\\')
      ++i;
    else if (c == '"')
      quoted = !quoted;
    else if (!quoted && (c == '[' || c == '{') && ++depth > 256)
      throw UserError(path + ": its JSON is nested more than 256 levels deep; export the file again");
    else if (!quoted && (c == ']' || c == '}'))
      --depth;
  }
}

/// The JSON of a file: all of a .gltf, the first chunk of a .glb.
std::string json_text(const std::string& bytes, bool binary) {
  if (!binary) return bytes;
  std::uint32_t length = 0;
  if (bytes.size() >= 20) std::memcpy(&length, bytes.data() + 12, sizeof length);
  return bytes.substr(std::min<std::size_t>(bytes.size(), 20), length);
}

}  // namespace

UserError unreadable(const std::string& path, std::string why, const std::string& remedy) {
  for (char& c : why)
    if (c == '\n' || c == '\r') c = ' ';
  while (!why.empty() && why.back() == ' ') why.pop_back();
  return UserError(path + ": not a readable glTF 2.0 file: " + why + "; " + remedy);
}

Document open_document(const std::string& path) {
  std::string bytes = read_file(path);
  if (bytes.empty()) throw UserError(path + ": the file is empty; give a glTF 2.0 scene (.gltf or .glb)");
  if (bytes.size() > 0xffffffffu)
    throw UserError(path + ": the file is larger than 4 GiB; keep its buffers in files beside it");
  bool binary = bytes.starts_with("glTF");
  std::string text = json_text(bytes, binary);
  check_nesting(text, path);
  std::string folder = std::filesystem::path(path).parent_path().string();
  tinygltf::TinyGLTF reader;
  // Few textures are used (emission.h): keep every image undecoded.
  reader.SetImageLoader(
      [](tinygltf::Image* image, const int, std::string*, std::string*, int, int, const unsigned char* data, int size,
         void*) {
        image->image.assign(data, data + size);
        return true;
      },
      nullptr);
  Document document{path, {}, {}};
  std::string error, warning;
  unsigned size = unsigned(bytes.size());
  bool good = false;
  try {
    good = binary ? reader.LoadBinaryFromMemory(&document.model, &error, &warning,
                                                reinterpret_cast<const unsigned char*>(bytes.data()), size, folder)
                  : reader.LoadASCIIFromString(&document.model, &error, &warning, bytes.data(), size, folder);
    if (good) document.root = nlohmann::json::parse(text);
  } catch (const std::exception& exception) {  // from the JSON library, on values of the wrong kind
    good = false, error = exception.what();
  }
  if (!good) throw unreadable(path, error, "it may be truncated, or files beside it are missing: export it again");
  for (const std::string& name : document.model.extensionsRequired)
    if (!extensions_read.contains(name))
      throw UserError(path + ": extensionsRequired names " + name + ", which is not read; export without it");
  return document;
}

}  // namespace alabaster

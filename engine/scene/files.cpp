#include "scene/files.h"

#include <filesystem>
#include <fstream>

#include "scene/error.h"

namespace alabaster {

std::string read_file(const std::string& path) {
  std::error_code error;
  auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw UserError(path + ": there is no such file; check the path");
  if (std::filesystem::is_directory(status)) throw UserError(path + ": this is a folder; give a file");
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  if (!in) throw UserError(path + ": the file cannot be opened; check its permissions");
  std::string bytes(std::max<std::streamoff>(in.tellg(), 0), '\0');
  in.seekg(0);
  if (!in.read(bytes.data(), std::streamsize(bytes.size())))
    throw UserError(path + ": the file cannot be read to its end");
  return bytes;
}

void write_file(const std::string& path, const std::string& bytes) {
  std::string draft = path + ".part";
  std::ofstream out(draft, std::ios::binary);
  bool written = out && out.write(bytes.data(), std::streamsize(bytes.size())).flush();
  out.close();
  std::error_code error;
  if (written) std::filesystem::rename(draft, path, error);
  if (!written || error) {
    std::filesystem::remove(draft, error);
    throw UserError(path + ": the file cannot be written; check that the folder exists, is writable and has room");
  }
}

}  // namespace alabaster

#include "arguments.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "scene/error.h"

namespace alabaster {

glm::ivec2 parse_size(const std::string& text) {
  glm::ivec2 size{0};
  int used = 0;
  if (std::sscanf(text.c_str(), "%dx%d%n", &size.x, &size.y, &used) != 2 || used != static_cast<int>(text.size()))
    throw UserError("--size " + text + ": write it as WIDTHxHEIGHT, for example 640x480");
  if (size.x < 1 || size.y < 1 || size.x > 16384 || size.y > 16384)
    throw UserError("--size " + text + ": width and height must lie between 1 and 16384 pixels");
  return size;
}

std::optional<int> parse_grid(const std::string& text) {
  if (text == "auto") return std::nullopt;
  int grid = 0, used = 0;
  if (std::sscanf(text.c_str(), "%d%n", &grid, &used) != 1 || used != static_cast<int>(text.size()))
    throw UserError("--grid " + text + ": write a number of cells, for example 64, or auto");
  return grid;
}

void check_writable(const std::string& path) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(path).has_parent_path() ? fs::path(path).parent_path() : fs::path(".");
  if (!fs::is_directory(folder))
    throw UserError(path + ": its folder " + folder.string() + " does not exist; make it first");
  if (fs::is_directory(path)) throw UserError(path + ": is a folder; name a file in it");
  // Tried, not asked: for root every folder claims to be writable.
  const std::string probe = path + ".probe-" + std::to_string(getpid());
  const int file = open(probe.c_str(), O_CREAT | O_EXCL | O_WRONLY, 0600);
  if (file < 0) throw UserError(path + ": cannot be written (" + std::strerror(errno) + "); choose another place");
  close(file);
  unlink(probe.c_str());
}

void print_warnings(const Scene& scene) {
  for (const std::string& warning : scene.warnings) std::fprintf(stderr, "warning: %s\n", warning.c_str());
}

}  // namespace alabaster

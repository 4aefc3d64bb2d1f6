// What several subcommands do with their arguments.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "scene/scene.h"

namespace alabaster {

/// "640x480" -> (640, 480). Throws UserError.
glm::ivec2 parse_size(const std::string& text);

/// "auto" -> nothing, "64" -> 64. Throws UserError.
std::optional<int> parse_grid(const std::string& text);

/// Throws UserError unless a file can be made at `path`: said before the work, not after it.
void check_writable(const std::string& path);

/// One line each on stderr.
void print_warnings(const Scene& scene);

}  // namespace alabaster

// Whole files in and out.
#pragma once

#include <string>
#include <vector>

namespace alabaster {

/// The bytes of a file. Throws UserError when it is missing, a folder or not readable.
std::string read_file(const std::string& path);

/// Writes beside `path` and renames, so that a file is there whole or not at all. Throws UserError when it cannot.
void write_file(const std::string& path, const std::string& bytes);

}  // namespace alabaster

// Files that appear whole or not at all.
#pragma once

#include <functional>
#include <string>

namespace alabaster {

/// Calls `write` with the name of a temporary file beside `path` and renames that file to `path` when it returns. When
/// it throws, the temporary file is removed and `path` stays as it was; what is thrown leaves as a UserError naming
/// `path`.
void write_whole_file(const std::string& path, const std::function<void(const std::string& temporary)>& write);

/// The same for a string of bytes.
void write_whole_file(const std::string& path, const std::string& bytes);

}  // namespace alabaster

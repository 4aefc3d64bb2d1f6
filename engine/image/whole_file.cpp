#include "image/whole_file.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "scene/error.h"

namespace alabaster {

void write_whole_file(const std::string& path, const std::function<void(const std::string&)>& write) {
  const std::string temporary = path + ".part" + std::to_string(::getpid());
  try {
    write(temporary);
    std::filesystem::rename(temporary, path);
  } catch (const std::exception& failure) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw UserError(path + ": cannot be written (" + failure.what() +
                    "); check that the folder exists, is writable and has room");
  }
}

void write_whole_file(const std::string& path, const std::string& bytes) {
  write_whole_file(path, [&](const std::string& temporary) {
    std::ofstream file(temporary, std::ios::binary);
    file.exceptions(std::ios::failbit | std::ios::badbit);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
  });
}

}  // namespace alabaster

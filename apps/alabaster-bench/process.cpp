#include "process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>

#include "scene/error.h"

extern char** environ;

namespace alabaster {

namespace fs = std::filesystem;

void RenderStudy::add_to(CLI::App& command) {
  command.add_option("scene", scene, "glTF 2.0 scene")->required();
  command.add_option("render_options", render_options, "options for `alabaster render`, after --");
  command.add_option("--runs", runs, "counted runs")->check(CLI::Range(1, 1000))->capture_default_str();
  command.add_option("--json", json, "medians (JSON)");
}

ProcessCost run_sibling(const std::string& program, const std::vector<std::string>& arguments) {
  const std::string path = (fs::read_symlink("/proc/self/exe").parent_path() / program).string();
  std::vector<std::string> words{path};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  const auto start = std::chrono::steady_clock::now();
  posix_spawn_file_actions_t quiet;  // the benchmark's own table is what belongs on stdout
  posix_spawn_file_actions_init(&quiet);
  posix_spawn_file_actions_addopen(&quiet, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int refused = posix_spawn(&child, path.c_str(), &quiet, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&quiet);
  if (refused != 0) throw UserError(path + " cannot be started; build it first");
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  const auto ms = [](const timeval& t) {
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_usec);
  };
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    std::string line = program;
    for (const std::string& argument : arguments) line += " " + argument;
    throw UserError(line + " failed; run it by itself to see why");
  }
  return {std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count(),
          ms(usage.ru_utime) + ms(usage.ru_stime), static_cast<double>(usage.ru_maxrss) / 1024};
}

Scratch::Scratch() : folder_(fs::temp_directory_path() / ("alabaster-bench-" + std::to_string(getpid()))) {
  fs::create_directories(folder_);
}

Scratch::~Scratch() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

}  // namespace alabaster

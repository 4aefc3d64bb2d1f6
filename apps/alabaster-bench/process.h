// Programs of ours run as a user runs them.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

namespace alabaster {

struct ProcessCost {
  double wall_ms = 0, cpu_ms = 0, peak_mib = 0;
};

/// Runs `program` of the folder this program is in, and waits. Throws UserError where it cannot be started or fails.
ProcessCost run_sibling(const std::string& program, const std::vector<std::string>& arguments);

/// What the benchmarks of whole renders are told.
struct RenderStudy {
  std::string scene, json;
  int runs = 7;
  std::vector<std::string> render_options;

  void add_to(CLI::App& command);
};

/// A folder for the files of one benchmark; removed at the end.
class Scratch {
 public:
  Scratch();
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  std::string operator/(const std::string& name) const { return (folder_ / name).string(); }

 private:
  std::filesystem::path folder_;
};

}  // namespace alabaster

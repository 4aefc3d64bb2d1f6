// Whole `alabaster render` processes: wall-clock time, peak memory, and the time of each stage from their --stats.
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "bench.h"
#include "image/whole_file.h"
#include "scene/error.h"

extern char** environ;

namespace alabaster {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string scene, json;
  int runs = 7;
  std::vector<std::string> render_options;
};

struct Run {
  double wall_ms = 0, peak_mib = 0;
  std::map<std::string, double> stages;
};

Run run_once(const Arguments& a, const fs::path& scratch) {
  const std::string renderer = (fs::read_symlink("/proc/self/exe").parent_path() / "alabaster").string();
  const std::string stats = (scratch / "stats.json").string();
  std::vector<std::string> words{renderer, "render", a.scene, "-o", (scratch / "out.exr").string(), "--stats", stats};
  words.insert(words.end(), a.render_options.begin(), a.render_options.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  const auto start = std::chrono::steady_clock::now();
  pid_t child = 0;
  if (posix_spawn(&child, renderer.c_str(), nullptr, nullptr, argv.data(), environ) != 0)
    throw UserError(renderer + " cannot be started; build it first");
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  Run run;
  run.wall_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  run.peak_mib = static_cast<double>(usage.ru_maxrss) / 1024;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw UserError("alabaster render " + a.scene + " failed; run it by itself to see why");
  std::ifstream file(stats);
  run.stages = nlohmann::json::parse(file).at("stages").get<std::map<std::string, double>>();
  return run;
}

void run_stages(const Arguments& a) {
  const fs::path scratch = fs::temp_directory_path() / ("alabaster-bench-" + std::to_string(getpid()));
  fs::create_directories(scratch);
  std::vector<double> wall, peak;
  std::map<std::string, std::vector<double>> stages;
  for (int i = -1; i < a.runs; ++i) {  // the first run fills the shader cache and is not counted
    const Run run = run_once(a, scratch);
    if (i < 0) continue;
    wall.push_back(run.wall_ms);
    peak.push_back(run.peak_mib);
    for (auto& [name, ms] : run.stages) stages[name].push_back(ms);
  }
  fs::remove_all(scratch);

  nlohmann::json json{{"scene", a.scene}, {"runs", a.runs}, {"wall_ms", median(wall)}, {"peak_mib", median(peak)}};
  std::printf("| stage | ms (median of %d) |\n| --- | --- |\n", a.runs);
  for (auto& [name, values] : stages) {
    std::printf("| %s | %.1f |\n", name.c_str(), median(values));
    json["stages"][name] = median(values);
  }
  std::printf("| whole process | %.0f (%.0f to %.0f) |\n| peak memory, MiB | %.0f |\n", median(wall),
              *std::min_element(wall.begin(), wall.end()), *std::max_element(wall.begin(), wall.end()), median(peak));
  if (!a.json.empty()) write_whole_file(a.json, json.dump(2) + "\n");
}

}  // namespace

void add_stages(CLI::App& app) {
  auto* command = app.add_subcommand("stages", "time of each stage and of the whole `alabaster render` process");
  auto a = std::make_shared<Arguments>();
  command->add_option("scene", a->scene, "glTF 2.0 scene")->required();
  command->add_option("render_options", a->render_options, "options for `alabaster render`, after --");
  command->add_option("--runs", a->runs, "counted runs")->check(CLI::Range(1, 1000))->capture_default_str();
  command->add_option("--json", a->json, "medians (JSON)");
  command->callback([a] { run_stages(*a); });
}

}  // namespace alabaster

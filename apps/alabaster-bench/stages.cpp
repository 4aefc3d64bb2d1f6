// Whole `alabaster render` processes: wall-clock time, peak memory, and the time of each stage from their --stats.
#include <cstdio>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "bench.h"
#include "image/whole_file.h"
#include "process.h"

namespace alabaster {
namespace {

void run_stages(const RenderStudy& a) {
  const Scratch scratch;
  const std::string stats = scratch / "stats.json";
  std::vector<std::string> words{"render", a.scene, "-o", scratch / "out.exr", "--stats", stats};
  words.insert(words.end(), a.render_options.begin(), a.render_options.end());
  std::vector<double> wall, cpu, peak;
  std::map<std::string, std::vector<double>> stages;
  for (int i = -1; i < a.runs; ++i) {  // the first run fills the shader cache and is not counted
    const ProcessCost cost = run_sibling("alabaster", words);
    if (i < 0) continue;
    wall.push_back(cost.wall_ms);
    cpu.push_back(cost.cpu_ms);
    peak.push_back(cost.peak_mib);
    std::ifstream file(stats);
    for (auto& [name, ms] : nlohmann::json::parse(file).at("stages").get<std::map<std::string, double>>())
      stages[name].push_back(ms);
  }

  nlohmann::json json{{"scene", a.scene},
                      {"runs", a.runs},
                      {"wall_ms", median(wall)},
                      {"cpu_ms", median(cpu)},
                      {"peak_mib", median(peak)}};
  std::printf("| stage | ms (median of %d) |\n| --- | --- |\n", a.runs);
  for (auto& [name, values] : stages) {
    std::printf("| %s | %.0f |\n", name.c_str(), median(values));
    json["stages"][name] = median(values);
  }
  const auto [least, most] = std::minmax_element(wall.begin(), wall.end());
  std::printf(
      "| whole process | %.0f (%.0f to %.0f) |\n| processor time, all threads | %.0f |\n| peak memory, MiB | %.0f |\n",
      median(wall), *least, *most, median(cpu), median(peak));
  if (!a.json.empty()) write_whole_file(a.json, json.dump(2) + "\n");
}

}  // namespace

void add_stages(CLI::App& app) {
  auto* command = app.add_subcommand("stages", "time of each stage and of the whole `alabaster render` process");
  auto a = std::make_shared<RenderStudy>();
  a->add_to(*command);
  command->callback([a] { run_stages(*a); });
}

}  // namespace alabaster

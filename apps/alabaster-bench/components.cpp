// What each component and each transport adds to a frame: whole `alabaster render` processes side by side. The
// machine's load drifts, so every round runs all of them, and a cost is the median of the differences within a round.
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "bench.h"
#include "image/whole_file.h"
#include "process.h"

namespace alabaster {
namespace {

struct Variant {
  std::string name;
  std::vector<std::string> options;
  int base = -1;  // of the variant that its cost is counted from; -1: none
};

const std::vector<Variant>& variants() {
  const std::string components = "--components", transport = "--transport";
  static const std::vector<Variant> all{
      {"multiple, report", {transport, "report", components, "multiple", "--interreflections", "0"}},
      {"+ surface", {transport, "report", components, "multiple,surface", "--interreflections", "0"}, 0},
      {"+ light between surfaces", {transport, "report", components, "multiple,surface"}, 1},
      {"+ single by itself", {transport, "report", components, "multiple,single,surface"}, 2},
      {"the third by directional", {transport, "directional", components, "multiple,surface"}, 2},
      {"the third by beam", {transport, "beam", components, "multiple,surface"}, 2},
      {"the third by gather", {transport, "gather", components, "multiple,surface"}, 2},
      {"gather + single by itself (the default)", {transport, "gather", components, "multiple,single,surface"}, 6}};
  return all;
}

struct Times {
  std::vector<double> wall, cpu;  // ms, one a round
};

std::vector<Times> measured(const RenderStudy& a) {
  const Scratch scratch;
  std::vector<Times> times(variants().size());
  for (int round = -1; round < a.runs; ++round)  // the first round fills the shader cache and is not counted
    for (std::size_t v = 0; v < times.size(); ++v) {
      std::vector<std::string> words{"render", a.scene, "-o", scratch / "out.exr"};
      words.insert(words.end(), variants()[v].options.begin(), variants()[v].options.end());
      words.insert(words.end(), a.render_options.begin(), a.render_options.end());
      const ProcessCost cost = run_sibling("alabaster", words);
      if (round < 0) continue;
      times[v].wall.push_back(cost.wall_ms);
      times[v].cpu.push_back(cost.cpu_ms);
    }
  return times;
}

double median_difference(const std::vector<double>& values, const std::vector<double>& base) {
  std::vector<double> differences;
  for (std::size_t i = 0; i < values.size(); ++i) differences.push_back(values[i] - base[i]);
  return median(differences);
}

void run_components(const RenderStudy& a) {
  const std::vector<Times> times = measured(a);
  nlohmann::json json{{"scene", a.scene}, {"runs", a.runs}, {"rows", nlohmann::json::array()}};
  std::printf(
      "| drawn | wall, ms (of %d) | processor, ms | adds: wall | adds: processor |\n| --- | --- | --- | --- | --- |\n",
      a.runs);
  for (std::size_t v = 0; v < times.size(); ++v) {
    const Variant& variant = variants()[v];
    nlohmann::json row{{"name", variant.name},
                       {"options", variant.options},
                       {"wall_ms", median(times[v].wall)},
                       {"cpu_ms", median(times[v].cpu)}};
    std::printf("| %s | %.0f | %.0f |", variant.name.c_str(), median(times[v].wall), median(times[v].cpu));
    if (variant.base >= 0) {
      const Times& base = times[static_cast<std::size_t>(variant.base)];
      row["adds_to"] = variants()[static_cast<std::size_t>(variant.base)].name;
      row["adds_wall_ms"] = median_difference(times[v].wall, base.wall);
      row["adds_cpu_ms"] = median_difference(times[v].cpu, base.cpu);
      std::printf(" %+.0f | %+.0f |\n", row["adds_wall_ms"].get<double>(), row["adds_cpu_ms"].get<double>());
    } else {
      std::printf(" | |\n");
    }
    json["rows"].push_back(std::move(row));
  }
  if (!a.json.empty()) write_whole_file(a.json, json.dump(2) + "\n");
}

}  // namespace

void add_components(CLI::App& app) {
  auto* command = app.add_subcommand("components", "what each component and transport adds to a frame, side by side");
  auto a = std::make_shared<RenderStudy>();
  a->add_to(*command);
  command->callback([a] { run_components(*a); });
}

}  // namespace alabaster

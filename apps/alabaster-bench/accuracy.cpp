// Renders against path-traced references: what model and grid together are worth. A column for each transport, grid and
// layer that is asked for; nothing is tuned.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "bench.h"
#include "image/picture.h"
#include "image/whole_file.h"
#include "process.h"

namespace alabaster {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string meshes = "build/meshes", references, json, size = "160x120";
  std::vector<std::string> shapes{"bunny", "armadillo", "dragon"}, sizes{"20", "50", "200"},
      albedos{"0.9", "0.99", "0.999"}, etas{"1.0", "1.3", "1.5"}, scenes, transports{"report"}, grids{"64"},
      layers{"subsurface"}, render_options;
  int spp = 256;
};

struct Row {
  std::string label;
  std::vector<std::string> scenes;  // in its columns
};

/// The rows of the table and the heads of its columns, before transports, grids and layers split these.
struct Plan {
  std::string head;
  std::vector<std::string> columns;
  std::vector<Row> rows;
};

Plan plan_of(const Arguments& a) {
  Plan plan;
  if (!a.scenes.empty()) {
    plan.head = "| scene |";
    plan.columns = {""};
    for (const std::string& scene : a.scenes) plan.rows.push_back({"| " + scene + " |", {scene}});
    return plan;
  }
  plan.head = "| object | mean free paths | albedo |";
  for (const std::string& eta : a.etas) plan.columns.push_back("eta " + eta);
  for (const std::string& shape : a.shapes)
    for (const std::string& size : a.sizes)
      for (const std::string& albedo : a.albedos) {
        Row row{"| " + shape + " | " + size + " | " + albedo + " |", {}};
        for (const std::string& eta : a.etas) row.scenes.push_back(shape + "-" + size + "mfp-" + albedo + "-" + eta);
        plan.rows.push_back(row);
      }
  return plan;
}

/// A picture that says it has enough samples and whose run left nothing to go on from is taken as it is.
bool finished(const std::string& reference, int spp) {
  if (!fs::exists(reference) || fs::exists(reference + ".state")) return false;
  const Picture picture = read_exr(reference);
  const auto samples = picture.attributes.find("samplesPerPixel");
  const auto* number = samples == picture.attributes.end() ? nullptr : std::get_if<double>(&samples->second);
  return number && *number >= spp;
}

nlohmann::json figures_of(const std::string& file_name) {
  std::ifstream file(file_name);
  return nlohmann::json::parse(file);
}

class Judge {
 public:
  explicit Judge(const Arguments& a) : a_(a), folder_(a.references.empty() ? scratch_ / "" : a.references + "/") {
    fs::create_directories(folder_);
  }

  /// One set of figures for each transport, grid and layer, in this order.
  std::vector<nlohmann::json> operator()(const std::string& name) {
    const std::string scene = folder_ + name + ".glb", reference = folder_ + name + ".exr",
                      test = scratch_ / "test.exr", figures = scratch_ / "figures.json";
    run_sibling("alabaster-scenes", {folder_, "--meshes", a_.meshes, "--names", name});
    if (!finished(reference, a_.spp))
      run_sibling("alabaster", {"reference", scene, "-o", reference, "--size", a_.size, "--spp", std::to_string(a_.spp),
                                "--resume"});
    std::vector<nlohmann::json> all;
    for (const std::string& transport : a_.transports)
      for (const std::string& grid : a_.grids) {
        std::vector<std::string> words{"render", scene,    "-o", test,          "--size",
                                       a_.size,  "--grid", grid, "--transport", transport};
        words.insert(words.end(), a_.render_options.begin(), a_.render_options.end());
        run_sibling("alabaster", words);
        for (const std::string& layer : a_.layers) {
          run_sibling("alabaster", {"compare", test, reference, "--layer", layer, "--json", figures});
          nlohmann::json json = figures_of(figures);
          json["scene"] = name, json["transport"] = transport, json["grid"] = grid, json["layer"] = layer;
          all.push_back(std::move(json));
        }
      }
    return all;
  }

 private:
  const Arguments& a_;
  const Scratch scratch_;
  const std::string folder_;
};

/// Heads of the columns that one scene fills: what is the same in all of them is left out.
std::vector<std::string> split_heads(const Arguments& a) {
  std::vector<std::string> heads;
  for (const std::string& transport : a.transports)
    for (const std::string& grid : a.grids)
      for (const std::string& layer : a.layers)
        heads.push_back((a.transports.size() > 1 ? transport + " " : "") + (a.grids.size() > 1 ? grid + "^3 " : "") +
                        (a.layers.size() > 1 ? layer + " " : ""));
  return heads;
}

void run_accuracy(const Arguments& a) {
  const Plan plan = plan_of(a);
  Judge judge(a);
  nlohmann::json rows = nlohmann::json::array();
  std::fprintf(stderr, "relative RMSE (the reference's noise taken out where it is known) / bias, percent, %s pixels\n",
               a.size.c_str());
  std::string head = plan.head, rule;
  for (const std::string& column : plan.columns)
    for (const std::string& split : split_heads(a))
      head += " " + split + (split.empty() && column.empty() ? "figures" : column) + " |";
  for (char c : head)
    if (c == '|') rule += rule.empty() ? "|" : " --- |";
  std::printf("%s noise |\n%s --- |\n", head.c_str(), rule.c_str());
  for (const Row& row : plan.rows) {
    std::printf("%s", row.label.c_str());
    double noise = 0;
    for (const std::string& scene : row.scenes)
      for (nlohmann::json& figures : judge(scene)) {
        double rmse = figures.at("relative_rmse").get<double>();
        if (figures.contains("z_test") && figures["z_test"].is_object()) {
          rmse = figures["z_test"].at("noise_corrected_rmse").get<double>();
          noise = std::max(noise, figures["z_test"].at("noise").get<double>());
        }
        std::printf(" %.1f / %+.1f |", 100 * rmse, 100 * figures.at("bias").get<double>());
        std::fflush(stdout);
        rows.push_back(std::move(figures));
      }
    std::printf(" %.1f |\n", 100 * noise);
  }
  if (!a.json.empty()) write_whole_file(a.json, rows.dump(2) + "\n");
}

}  // namespace

void add_accuracy(CLI::App& app) {
  auto* command =
      app.add_subcommand("accuracy", "renders against path-traced references: a table of relative RMSE and bias");
  auto a = std::make_shared<Arguments>();
  command->add_option("--meshes", a->meshes, "folder of the scanned meshes (third_party/fetch-meshes)")
      ->capture_default_str();
  command->add_option("--references", a->references,
                      "folder that keeps scenes and references; an unfinished one goes on (default: none is kept)");
  command->add_option("--scenes", a->scenes, "scenes of alabaster-scenes, in place of the product of the next four")
      ->delimiter(',');
  command->add_option("--shapes", a->shapes, "objects")->delimiter(',');
  command->add_option("--mfp", a->sizes, "sizes in mean free paths")->delimiter(',');
  command->add_option("--albedos", a->albedos, "reduced albedos")->delimiter(',');
  command->add_option("--etas", a->etas, "relative indices")->delimiter(',');
  command->add_option("--size", a->size, "WIDTHxHEIGHT, pixels")->capture_default_str();
  command->add_option("--spp", a->spp, "samples a pixel of the reference")->capture_default_str();
  command->add_option("--transport", a->transports, "of the render, a column each")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--grid", a->grids, "cells along the longest side, a column each")
      ->delimiter(',')
      ->capture_default_str();
  command
      ->add_option("--layers", a->layers, "what is compared, a column each: sum, subsurface, multiple, single, surface")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("render_options", a->render_options, "more for alabaster render, after --");
  command->add_option("--json", a->json, "all figures (JSON)");
  command->callback([a] { run_accuracy(*a); });
}

}  // namespace alabaster

// Renders against path-traced references over shapes, optical sizes, albedos and indices: what the model and the grid
// together are worth. One row a scene; nothing is tuned.
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "bench.h"
#include "image/whole_file.h"
#include "process.h"

namespace alabaster {
namespace {

struct Arguments {
  std::string meshes = "build/meshes", json, size = "160x120";
  std::vector<std::string> shapes{"bunny", "armadillo", "dragon"}, sizes{"20", "50", "200"},
      albedos{"0.9", "0.99", "0.999"}, etas{"1.0", "1.3", "1.5"};
  int spp = 256, grid = 64;
};

nlohmann::json judge(const Arguments& a, const Scratch& scratch, const std::string& name) {
  const std::string scene = scratch / (name + ".glb"), reference = scratch / "reference.exr",
                    test = scratch / "test.exr", figures = scratch / "figures.json";
  run_sibling("alabaster-scenes", {scratch / "", "--meshes", a.meshes, "--names", name});
  const ProcessCost cost =
      run_sibling("alabaster", {"reference", scene, "-o", reference, "--size", a.size, "--spp", std::to_string(a.spp)});
  run_sibling("alabaster", {"render", scene, "-o", test, "--size", a.size, "--grid", std::to_string(a.grid)});
  run_sibling("alabaster", {"compare", test, reference, "--layer", "subsurface", "--json", figures});
  std::ifstream file(figures);
  nlohmann::json json = nlohmann::json::parse(file);
  json["scene"] = name;
  json["reference_seconds"] = 1e-3 * cost.cpu_ms;
  return json;
}

void run_accuracy(const Arguments& a) {
  const Scratch scratch;
  nlohmann::json rows = nlohmann::json::array();
  std::fprintf(stderr, "all but the surface's reflection, %s, grid %d, reference %d samples a pixel\n", a.size.c_str(),
               a.grid, a.spp);
  std::printf(
      "| object | mean free paths | albedo | eta | relative RMSE %%, noise taken out | bias %% | reference noise %% | "
      "reference, processor s |\n");
  std::printf("| --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (const std::string& shape : a.shapes)
    for (const std::string& size : a.sizes)
      for (const std::string& albedo : a.albedos)
        for (const std::string& eta : a.etas) {
          nlohmann::json row = judge(a, scratch, shape + "-" + size + "mfp-" + albedo + "-" + eta);
          const nlohmann::json& z = row.at("z_test");
          std::printf("| %s | %s | %s | %s | %.1f | %+.1f | %.1f | %.0f |\n", shape.c_str(), size.c_str(),
                      albedo.c_str(), eta.c_str(), 100 * z.at("noise_corrected_rmse").get<double>(),
                      100 * row.at("bias").get<double>(), 100 * z.at("noise").get<double>(),
                      row.at("reference_seconds").get<double>());
          std::fflush(stdout);
          rows.push_back(std::move(row));
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
  command->add_option("--shapes", a->shapes, "objects")->delimiter(',');
  command->add_option("--mfp", a->sizes, "sizes in mean free paths")->delimiter(',');
  command->add_option("--albedos", a->albedos, "reduced albedos")->delimiter(',');
  command->add_option("--etas", a->etas, "relative indices")->delimiter(',');
  command->add_option("--size", a->size, "WIDTHxHEIGHT, pixels")->capture_default_str();
  command->add_option("--spp", a->spp, "samples a pixel of the reference")->capture_default_str();
  command->add_option("--grid", a->grid, "cells along the longest side")->capture_default_str();
  command->add_option("--json", a->json, "all figures (JSON)");
  command->callback([a] { run_accuracy(*a); });
}

}  // namespace alabaster

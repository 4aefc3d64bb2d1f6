// Renders against path-traced references: what model and grid together are worth. Nothing is tuned. With one layer a
// scene fills a column for each transport and grid; with several, a row for each of these and a column a layer.
#include <cstdio>
#include <filesystem>
#include <memory>

#include "bench.h"
#include "compare/compare.h"
#include "compare/gallery.h"
#include "image/whole_file.h"
#include "judge.h"
#include "summary.h"

namespace alabaster {
namespace {

struct Arguments {
  JudgeOptions judge;
  std::string json, sheets, gallery;
  std::vector<std::string> shapes{"bunny", "armadillo", "dragon"}, sizes{"20", "50", "200"},
      albedos{"0.9", "0.99", "0.999"}, etas{"1.0", "1.3", "1.5"}, scenes;
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

Plan plan_of_scenes(const std::vector<std::string>& scenes) {
  Plan plan{"| scene |", {""}, {}};
  for (const std::string& scene : scenes) plan.rows.push_back({"| " + scene + " |", {scene}});
  return plan;
}

Plan plan_of(const Arguments& a) {
  if (!a.scenes.empty()) return plan_of_scenes(a.scenes);
  Plan plan;
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

struct Cell {
  std::string text = " - |";
  double noise = 0;  // of the reference, relative; 0 where it is not known
};

Cell cell_of(const std::optional<nlohmann::json>& figures) {
  Cell cell;
  if (!figures) return cell;
  const nlohmann::json& z = figures->at("z_test");
  const double rmse = rmse_of(*figures);
  if (z.is_object()) cell.noise = z.at("noise").get<double>();
  char text[64];
  std::snprintf(text, sizeof text, " %.1f%s / %+.1f |", 100 * rmse, z.is_object() ? "" : "*",
                100 * figures->at("bias").get<double>());
  cell.text = text;
  return cell;
}

void print_head(const std::string& head) {
  std::string rule;
  for (char c : head)
    if (c == '|') rule += rule.empty() ? "|" : " --- |";
  std::printf("%s\n%s\n", head.c_str(), rule.c_str());
}

/// What tells apart the renders of one scene: transport and grid, where there are several of these.
std::string split_of(const JudgeOptions& o, const std::string& transport, const std::string& grid,
                     const std::string& between) {
  return (o.transports.size() > 1 ? transport + between : "") + (o.grids.size() > 1 ? grid + between : "");
}

class Table {
 public:
  explicit Table(const Arguments& a) : a_(a), judge_(a.judge) {}

  /// One layer: the renders of a scene side by side.
  void by_renders(const Plan& plan) {
    std::string head = plan.head;
    for (const std::string& column : plan.columns)
      for (const std::string& transport : a_.judge.transports)
        for (const std::string& grid : a_.judge.grids) {
          const std::string split = split_of(a_.judge, transport, grid + "^3", " ");
          head += " " + split + (split.empty() && column.empty() ? "figures" : column) + " |";
        }
    print_head(head + " noise |");
    for (const Row& row : plan.rows) {
      std::printf("%s", row.label.c_str());
      double noise = 0;
      for (const std::string& scene : row.scenes)
        for (const Verdict& verdict : judged(scene))
          for (double of_layer : print_cells(verdict)) noise = std::max(noise, of_layer);
      std::printf(" %.1f |\n", 100 * noise);
    }
  }

  /// Several layers side by side: a row for each render.
  void by_layers(const Plan& plan) {
    std::string head = "| scene |" + split_of(a_.judge, " transport", " grid", " |");
    for (const std::string& layer : a_.judge.layers) head += " " + layer + " |";
    print_head(head + " noise |");
    for (const Row& row : plan.rows)
      for (const std::string& scene : row.scenes)
        for (const Verdict& verdict : judged(scene)) {
          std::printf("| %s |%s", scene.c_str(),
                      split_of(a_.judge, " " + verdict.transport, " " + verdict.grid + "^3", " |").c_str());
          std::string noise;
          for (double of_layer : print_cells(verdict)) {
            char text[32] = "-";
            if (of_layer > 0) std::snprintf(text, sizeof text, "%.1f", 100 * of_layer);
            noise += (noise.empty() ? " " : " / ") + std::string(text);
          }
          std::printf("%s |\n", noise.c_str());
        }
  }

  void write() const {
    const std::string summary = summary_of(json_);
    if (!summary.empty()) std::printf("\n%s", summary.c_str());
    if (!a_.json.empty()) write_whole_file(a_.json, json_.dump(2) + "\n");
    if (!a_.gallery.empty()) write_gallery(gallery_, 2, a_.gallery);
  }

 private:
  std::vector<Verdict> judged(const std::string& scene) {
    std::vector<Verdict> verdicts = judge_(scene);
    if (!a_.sheets.empty() || !a_.gallery.empty()) keep_pictures(scene, verdicts);
    for (const Verdict& verdict : verdicts)
      for (const auto& figures : verdict.figures)
        if (figures) json_.push_back(*figures);
    return verdicts;
  }

  /// Returns the reference's noise in each layer, 0 where it is not known.
  std::vector<double> print_cells(const Verdict& verdict) const {
    std::vector<double> noise;
    for (const auto& figures : verdict.figures) {
      const Cell cell = cell_of(figures);
      std::printf("%s", cell.text.c_str());
      noise.push_back(cell.noise);
    }
    std::fflush(stdout);
    return noise;
  }

  void keep_pictures(const std::string& scene, const std::vector<Verdict>& verdicts) {
    const Picture reference = read_exr(judge_.reference_of(scene));
    GalleryRow row;
    for (const Verdict& v : verdicts) {
      const std::string name = scene + "-" + v.transport + "-" + v.grid;
      row.push_back({scene + ", " + v.transport, v.test});
      if (a_.sheets.empty()) continue;
      write_exr(v.test, a_.sheets + "/" + name + ".exr", true);
      for (std::size_t i = 0; i < v.figures.size(); ++i)
        if (v.figures[i])
          write_sheet(compare(v.test, reference,
                              {.layer = a_.judge.layers[i], .test_name = name, .reference_name = "reference"}),
                      a_.sheets + "/" + name + "-" + a_.judge.layers[i] + ".png");
    }
    row.push_back({"path traced", reference});
    gallery_.push_back(std::move(row));
  }

  const Arguments& a_;
  Judge judge_;
  nlohmann::json json_ = nlohmann::json::array();
  std::vector<GalleryRow> gallery_;
};

void run_accuracy(const Arguments& a) {
  const Plan plan = plan_of(a);
  if (!a.sheets.empty()) std::filesystem::create_directories(a.sheets);
  std::fprintf(stderr,
               "relative RMSE (the reference's noise taken out; *: not known and left in) / bias, percent, each of its "
               "layer's mean; %s pixels; -: the pictures do not have the layer apart\n",
               a.judge.size.c_str());
  Table table(a);
  if (a.judge.layers.size() > 1)
    table.by_layers(plan);
  else
    table.by_renders(plan);
  table.write();
}

}  // namespace

void add_accuracy(CLI::App& app) {
  auto* command =
      app.add_subcommand("accuracy", "renders against path-traced references: a table of relative RMSE and bias");
  auto a = std::make_shared<Arguments>();
  JudgeOptions& judge = a->judge;
  command->add_option("--meshes", judge.meshes, "folder of the scanned meshes (third_party/fetch-meshes)")
      ->capture_default_str();
  command->add_option("--references", judge.references,
                      "folder that keeps scenes and references; an unfinished one goes on (default: none is kept)");
  command->add_option("--scenes", a->scenes, "scenes of alabaster-scenes, in place of the product of the next four")
      ->delimiter(',');
  command->add_option("--shapes", a->shapes, "objects")->delimiter(',');
  command->add_option("--mfp", a->sizes, "sizes in mean free paths")->delimiter(',');
  command->add_option("--albedos", a->albedos, "reduced albedos")->delimiter(',');
  command->add_option("--etas", a->etas, "relative indices")->delimiter(',');
  command->add_option("--size", judge.size, "WIDTHxHEIGHT, pixels")->capture_default_str();
  command->add_option("--spp", judge.spp, "samples a pixel of the reference")->capture_default_str();
  command->add_option("--transport", judge.transports, "of the render, one or several")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--grid", judge.grids, "cells along the longest side, one or several")
      ->delimiter(',')
      ->capture_default_str();
  command
      ->add_option("--layers", judge.layers,
                   "what is compared: sum, subsurface, multiple, single, surface; with multiple or single the render "
                   "draws single scattering by itself")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("render_options", judge.render_options, "more for alabaster render, after --");
  command->add_option("--json", a->json, "all figures (JSON)");
  command->add_option("--sheets", a->sheets, "folder for renders (EXR) and comparison sheets (PNG)");
  command->add_option("--gallery", a->gallery, "all renders beside their references on one picture (PNG or JPEG)");
  command->callback([a] { run_accuracy(*a); });
}

}  // namespace alabaster

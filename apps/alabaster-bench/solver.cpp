// The solver by itself: iterations and times by contrast, shape and grid; channels; solves that start from a solution.
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "body.h"
#include "image/whole_file.h"

namespace alabaster {
namespace {

struct Arguments : BodyStudy {
  Arguments() {
    shapes = {"ball", "bunny", "armadillo"};
    contrasts = {1, 1e2, 1e4, 1e6};
  }
  bool largest = false;
  std::vector<std::string> tables{"contrasts", "repeats", "growth"};
};

using Json = nlohmann::json;

struct Timed {
  double set_up, solve;  // ms
  SolverStatus status;
};

Timed timed(BenchBody& body, int runs) {
  Timed t;
  t.set_up = median_time(
      runs, [] {}, [&] { body.diffusion().multigrid().set_up(); });
  t.solve = median_time(
      runs, [&] { body.forget(); }, [&] { t.status = body.solve(); });
  return t;
}

// One linear system each, without deferred corrections.
Json contrasts(gpu::Context& context, const Arguments& a) {
  Json rows = Json::array();
  std::printf(
      "| shape | medium | contrast | grid | islands | iterations | residual | set-up ms | solve ms |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  SolverOptions options;
  options.corrections = 0;
  for (const std::string& name : a.shapes) {
    const Shape shape = shape_named(name, a.meshes);
    for (const double contrast : a.contrasts)
      for (const bool veins : {false, true}) {
        if (veins && contrast == 1) continue;
        for (const int grid : a.grids) {
          BenchBody body(context, shape.mesh, grid, veins ? vein_medium(0.4, contrast) : checker_medium(0.11, contrast),
                         1, options);
          const Multigrid& multigrid = body.diffusion().multigrid();
          const auto [set_up, solve, status] = timed(body, a.runs);
          const char* medium = veins ? "veins" : "checker";
          std::printf("| %s | %s | %.0e | %d | %d | %d%s | %.1e | %.0f | %.0f |\n", name.c_str(), medium, contrast,
                      grid, multigrid.deflation().count(), status.iterations,
                      status.converged ? "" : " (not converged)", status.relative_residual[0], set_up, solve);
          std::fflush(stdout);
          rows.push_back({{"grid", grid},
                          {"shape", name},
                          {"medium", medium},
                          {"contrast", contrast},
                          {"channels", 1},
                          {"islands", multigrid.deflation().count()},
                          {"iterations", status.iterations},
                          {"converged", status.converged},
                          {"true_residual", status.relative_residual[0]},
                          {"setup_ms", set_up},
                          {"solve_ms", solve}});
        }
      }
  }
  return rows;
}

// A medium of three colours that differ.
MediumField coloured(double edit = 1) {
  return [edit](glm::dvec3 p) {
    const double s = std::sin(19 * p.x + 3 * p.y + 1) * std::sin(23 * p.y - 4 * p.z) * std::sin(17 * p.z + 5 * p.x + 2);
    MediumPoint m = scatterer(glm::dvec3(0.02, 0.015, 0.01) * std::pow(100.0, 0.5 * (s - 1)));
    m.sigma_a = glm::dvec3(0.3, 0.6, 1.2) * (p.x > 0 ? edit : 1.0);
    m.sigma_s_reduced *= p.x > 0 ? edit : 1.0;
    return m;
  };
}

// Sun light that has gone round by so many degrees.
void sun(BenchBody& body, double degrees) {
  const double turn = degrees * std::numbers::pi / 180;
  body.light({0.3 * std::cos(turn) + std::sin(turn), std::cos(turn) - 0.3 * std::sin(turn), 0.2});
}

// Whole solves, deferred corrections included. Cold: from zero. Light moved once: one solution is known. Light on its
// way: 3 degrees a frame, after four frames. Medium edited: its set-up and a solve from the solution of before.
Json repeats(gpu::Context& context, const Arguments& a) {
  Json rows = Json::array();
  std::printf(
      "\nmilliseconds, iterations (share of the cold solve; of set-up and cold solve)\n\n"
      "| bunny, grid | channels | set-up | cold solve | light moved once, by 10 degrees | light on its way | medium "
      "edited by a fifth |\n| --- | --- | --- | --- | --- | --- | --- |\n");
  const Mesh mesh = shape_named("bunny", a.meshes).mesh;
  SolverOptions options;
  options.history = true;
  for (const int grid : a.grids)
    for (const int channels : {1, 3}) {
      BenchBody body(context, mesh, grid, coloured(), channels, options);
      const MediumSamples first = body.sampled(coloured()), second = body.sampled(coloured(1.2)),
                          other = body.sampled(coloured(3));
      MediumSamples handed;  // sampling and copying are not the solver's
      SolverStatus status;
      const double set_up = median_time(
          a.runs,
          [&] {
            body.diffusion().set_medium(other);  // beyond what the coarse levels of `first` serve
            handed = first;
          },
          [&] { body.diffusion().set_medium(std::move(handed)); });
      const auto forget = [&] {
        body.diffusion().forget();
        sun(body, 0);
      };
      const double cold = median_time(a.runs, forget, [&] { status = body.solve(); });
      const int cold_iterations = status.iterations;
      const double moved = median_time(
          a.runs,
          [&] {
            forget();
            body.solve();
            sun(body, 10);
          },
          [&] { status = body.solve(); });
      const int moved_iterations = status.iterations;
      double degrees = 10;
      for (int frame = 0; frame < 4; ++frame) {
        sun(body, degrees += 3);
        body.solve();
      }
      const double under_way = median_time(
          a.runs, [&] { sun(body, degrees += 3); }, [&] { status = body.solve(); });
      const int under_way_iterations = status.iterations;
      const double edited = median_time(
          a.runs,
          [&] {
            body.diffusion().set_medium(other);
            body.diffusion().set_medium(first);
            body.solve();
            handed = second;
          },
          [&] {
            body.diffusion().set_medium(std::move(handed));
            status = body.solve();
          });
      std::printf("| %d | %d | %.0f | %.0f, %d |", grid, channels, set_up, cold, cold_iterations);
      for (const auto& [time, iterations] :
           {std::pair(moved, moved_iterations), {under_way, under_way_iterations}, {edited, status.iterations}})
        std::printf(" %.0f, %d (%.2f; %.2f) |", time, iterations, time / cold, time / (set_up + cold));
      std::printf("\n");
      std::fflush(stdout);
      rows.push_back({{"grid", grid},
                      {"shape", "bunny"},
                      {"channels", channels},
                      {"setup_ms", set_up},
                      {"cold_ms", cold},
                      {"light_moved_ms", moved},
                      {"light_under_way_ms", under_way},
                      {"material_edited_ms", edited}});
    }
  return rows;
}

Json growth(gpu::Context& context, const Arguments& a) {
  Json rows = Json::array();
  std::printf(
      "\n| shape | grid | inside cells | iterations | set-up, ns a cell | solve, ns a cell |\n"
      "| --- | --- | --- | --- | --- | --- |\n");
  const Mesh plate = transformed(box({1, 0.05f, 0.9f}), rotation({1, 2, 3}, 17));
  std::vector<std::pair<Shape, int>> list;
  for (const int grid : a.largest ? std::vector<int>{32, 64, 128, 192} : std::vector<int>{32, 64, 128})
    list.push_back({shape_named("ball", a.meshes), grid});
  list.push_back({{"plate of 0.05 m", plate}, 128});
  list.push_back({{"torus", torus(0.35f, 0.15f, 96, 48)}, 128});
  for (const auto& [shape, grid] : list) {
    BenchBody body(context, shape.mesh, grid, smooth_medium(1e2), 1);
    const auto [set_up, solve, status] = timed(body, a.runs);
    const double cells = body.inside_cells();
    std::printf("| %s | %d | %d | %d | %.0f | %.0f |\n", shape.name.c_str(), grid, body.inside_cells(),
                status.iterations, 1e6 * set_up / cells, 1e6 * solve / cells);
    std::fflush(stdout);
    rows.push_back({{"grid", grid},
                    {"shape", shape.name},
                    {"cells", body.inside_cells()},
                    {"iterations", status.iterations},
                    {"setup_ms", set_up},
                    {"solve_ms", solve}});
  }
  return rows;
}

void run_solver(const Arguments& a) {
  gpu::ContextOptions options;
  options.device = a.device;
  gpu::Context context(options);
  Json json{{"device", context.info().name}, {"runs", a.runs}};
  const auto asked = [&](const char* table) { return std::count(a.tables.begin(), a.tables.end(), table) > 0; };
  if (asked("contrasts")) json["contrasts"] = contrasts(context, a);
  if (asked("repeats")) json["repeats"] = repeats(context, a);
  if (asked("growth")) json["growth"] = growth(context, a);
  if (!a.json.empty()) write_whole_file(a.json, json.dump(2) + "\n");
}

}  // namespace

void add_solver(CLI::App& app) {
  auto* command = app.add_subcommand("solver", "iterations and times of the diffusion solver");
  auto a = std::make_shared<Arguments>();
  a->add_to(*command);
  command->add_option("--tables", a->tables, "contrasts, repeats, growth")
      ->delimiter(',')
      ->check(CLI::IsMember({"contrasts", "repeats", "growth"}))
      ->capture_default_str();
  command->add_flag("--largest", a->largest, "time per cell up to 192^3");
  command->callback([a] { run_solver(*a); });
}

}  // namespace alabaster

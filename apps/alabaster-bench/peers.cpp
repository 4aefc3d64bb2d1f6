// The same linear systems solved by us, by hypre (PFMG and BoomerAMG as preconditioners of conjugate gradients, one and
// two ranks, double precision) and by pyamg, turn by turn in one run.
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "body.h"
#include "image/whole_file.h"
#include "process.h"
#include "system_file.h"

namespace alabaster {
namespace {

using Json = nlohmann::json;

struct Arguments : BodyStudy {
  std::string python = "python3";
};

LinearSystem system_of(gpu::Context& context, BenchBody& body) {
  const glm::ivec3 n = body.domain().frame.cells;
  const std::vector<float> stencil = gpu::download<float>(context, body.diffusion().multigrid().finest().stencil);
  const std::vector<float> rhs = gpu::download<float>(context, body.diffusion().pcg().rhs());
  LinearSystem system{{n.x, n.y, n.z}, {}};
  system.values.reserve(LinearSystem::entries * system.cells());
  for (std::size_t cell = 0; cell < rhs.size(); ++cell) {
    const std::size_t row = cell / n.x, x = cell % n.x;
    for (int k = 0; k < DIFFUSION_FINEST_ENTRIES; ++k)
      system.values.push_back(stencil[x + n.x * (k + DIFFUSION_FINEST_ENTRIES * row)]);
    system.values.push_back(rhs[cell]);
  }
  return system;
}

// What a command prints, as JSON; null where it cannot be run.
Json output_of(const std::string& command) {
  std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen((command + " 2>/dev/null").c_str(), "r"), pclose);
  std::string text;
  char part[256];
  while (pipe && std::fgets(part, sizeof part, pipe.get())) text += part;
  return Json::parse(text, nullptr, false).is_discarded() ? Json() : Json::parse(text);
}

struct Peer {
  std::string name, command;  // with the system's file at the end
};

std::vector<Peer> peers_here(const Arguments& a) {
  std::vector<Peer> list;
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const std::string hypre = (here / "alabaster-hypre").string();
  if (std::filesystem::exists(hypre))
    for (const char* method : {"pfmg", "boomeramg"})
      for (const int ranks : {1, 2}) {
        const std::string mpi = "mpirun --allow-run-as-root --oversubscribe -n " + std::to_string(ranks);
        list.push_back({method + std::string(ranks == 1 ? "" : " x2"), mpi + " " + hypre + " " + method + " "});
      }
  const std::string script = ALABASTER_SOURCE "/bench/pyamg_solve.py";
  if (!output_of(a.python + " " + script + " --available").is_null())
    list.push_back({"pyamg", a.python + " " + script + " "});
  return list;
}

Json row_of(gpu::Context& context, const Arguments& a, const Shape& shape, int grid, double contrast,
            const std::vector<Peer>& peers) {
  SolverOptions options;
  options.corrections = 0;
  BenchBody body(context, shape.mesh, grid, checker_medium(0.11, contrast), 1, options);
  body.solve();
  const Scratch scratch;
  const std::string file = scratch / "system.bin";
  system_of(context, body).write(file);
  std::vector<double> set_up, solve;
  std::map<std::string, std::vector<double>> times;
  Json row{{"grid", grid}, {"shape", shape.name}, {"contrast", contrast}, {"channels", 1}, {"peers", Json::object()}};
  for (int run = 0; run < a.runs; ++run) {  // in turn, so that a busy machine is busy for all
    set_up.push_back(time_of([&] { body.diffusion().multigrid().set_up(); }));
    body.forget();
    SolverStatus status;
    solve.push_back(time_of([&] { status = body.diffusion().pcg().solve(); }));
    row["iterations"] = status.iterations;
    row["true_residual"] = status.relative_residual[0];
    for (const Peer& peer : peers) {
      const Json result = output_of(peer.command + file);
      if (result.is_null()) continue;
      times[peer.name].push_back(result.at("setup_ms").get<double>() + result.at("solve_ms").get<double>());
      row["peers"][peer.name] = {{"ms", median(times[peer.name])},
                                 {"iterations", result.at("iterations")},
                                 {"true_residual", result.at("residual")}};
    }
  }
  row["setup_ms"] = median(set_up);
  row["solve_ms"] = median(solve);
  return row;
}

void run_peers(const Arguments& a) {
  gpu::ContextOptions options;
  options.device = a.device;
  gpu::Context context(options);
  const std::vector<Peer> peers = peers_here(a);
  std::printf(
      "Milliseconds of set-up and solve (iterations), to a residual of 1e-6; ours in single precision, theirs in "
      "double.\n\n| shape | grid | contrast | ours |");
  for (const Peer& peer : peers) std::printf(" %s |", peer.name.c_str());
  std::printf("\n| --- | --- | --- | --- |");
  for (std::size_t i = 0; i < peers.size(); ++i) std::printf(" --- |");
  std::printf("\n");
  Json rows = Json::array();
  for (const std::string& name : a.shapes) {
    const Shape shape = shape_named(name, a.meshes);
    for (const int grid : a.grids)
      for (const double contrast : a.contrasts) {
        const Json row = row_of(context, a, shape, grid, contrast, peers);
        std::printf("| %s | %d | %.0e | %.0f + %.0f (%d) |", name.c_str(), grid, contrast,
                    row["setup_ms"].get<double>(), row["solve_ms"].get<double>(), row["iterations"].get<int>());
        for (const Peer& peer : peers) {
          if (row["peers"].contains(peer.name))
            std::printf(" %.0f (%d) |", row["peers"][peer.name]["ms"].get<double>(),
                        row["peers"][peer.name]["iterations"].get<int>());
          else
            std::printf(" failed |");
        }
        std::printf("\n");
        std::fflush(stdout);
        rows.push_back(row);
      }
  }
  const Json json{{"device", context.info().name}, {"rows", rows}};
  if (!a.json.empty()) write_whole_file(a.json, json.dump(2) + "\n");
}

}  // namespace

void add_peers(CLI::App& app) {
  auto* command = app.add_subcommand("peers", "the same linear systems by us, hypre and pyamg");
  auto a = std::make_shared<Arguments>();
  a->add_to(*command);
  command->add_option("--python", a->python, "a Python that has pyamg")->capture_default_str();
  command->callback([a] { run_peers(*a); });
}

}  // namespace alabaster

// The smoother's sweep on the device against the same sweep in plain C++ and against a copy of memory, turn by turn.
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "body.h"
#include "image/whole_file.h"
#include "sweep.h"

namespace alabaster {
namespace {

struct Arguments {
  std::string json, device;
  std::vector<int> grids{64, 128};
  int runs = 9, sweeps = 10;
};

void measure(gpu::Context& context, const Arguments& a, int grid, nlohmann::json& rows) {
  BenchBody body(context, box({1, 1, 1}), grid, checker_medium(0.3, 10), 1);
  const DiffusionPasses passes(context);
  Multigrid& multigrid = body.diffusion().multigrid();
  MultigridLevel& level = multigrid.finest();
  std::vector<float> half = gpu::download<float>(context, level.inverse_l1);  // where cells are, as the plain arrays
  for (float& v : half) v = v > 0 ? 0.5f : 0;
  for (const gpu::Image* image : {&level.x, &level.b}) gpu::upload(context, *image, half);
  gpu::Commands commands(context);
  for (int i = 0; i < a.sweeps; ++i)
    commands.dispatch(passes.smooth[1], multigrid.column_threads(),
                      {{"bricks", multigrid.columns().packed},
                       {"stencil", level.stencil},
                       {"inverse_l1", level.inverse_l1},
                       {"pairs", multigrid.pairs()},
                       {"x", i & 1 ? level.spare : level.x},
                       {"partials", body.diffusion().pcg().partials()},
                       {"b", level.b},
                       {"smoothed", i & 1 ? level.x : level.spare}},
                      LevelPush{level.cells, level.cells, 0.7f});
  commands.submit();

  const std::size_t count = std::size_t(grid + 2) * (grid + 2) * (grid + 2);
  std::vector<float> arrays[8];
  for (auto& array : arrays) array.assign(count, 0.5f);
  const PlainSystem system{
      grid, arrays[0].data(), arrays[1].data(), arrays[2].data(), arrays[3].data(), arrays[4].data(), arrays[5].data()};
  std::vector<float> from(std::size_t(1) << 26, 1.f), to(from.size());  // 256 MiB each: beyond every cache
  plain_copy(from.data(), to.data(), from.size());
  std::vector<double> ours, plain, copy;
  for (int run = 0; run < a.runs; ++run) {
    ours.push_back(time_of([&] { commands.submit(); }) / a.sweeps);
    plain.push_back(time_of([&] {
                      for (int i = 0; i < a.sweeps; ++i)
                        plain_sweep(system, 0.7f, arrays[6 + (i & 1)].data(), arrays[7 - (i & 1)].data());
                    }) /
                    a.sweeps);
    copy.push_back(time_of([&] { plain_copy(from.data(), to.data(), from.size()); }));
  }
  const double cells = body.inside_cells(), plain_cells = double(grid) * grid * grid;
  const double us = 1e-3 * cells / median(ours), them = 1e-3 * plain_cells / median(plain);  // million updates a second
  const double bandwidth = 1e-6 * 2 * sizeof(float) * double(from.size()) / median(copy);    // GB/s
  const double used = 1e-3 * us * (3 + DIFFUSION_PAIRS) * sizeof(float);  // x, b and pairs of bf16 in, x out
  std::printf("| %d | %.0f | %.0f | %.2f | %.1f | %.2f |\n", grid, us, them, us / them, bandwidth, used / bandwidth);
  std::fflush(stdout);
  rows.push_back({{"grid", grid},
                  {"mega_updates", us},
                  {"plain_mega_updates", them},
                  {"copy_gb_per_s", bandwidth},
                  {"share_of_plain", us / them},
                  {"share_of_copy", used / bandwidth}});
}

void run_smoother(const Arguments& a) {
  gpu::ContextOptions options;
  options.device = a.device;
  gpu::Context context(options);
  nlohmann::json json{{"device", context.info().name}, {"rows", nlohmann::json::array()}};
  std::printf(
      "| grid | million updates/s | plain C++ | share | STREAM copy GB/s | share |\n"
      "| --- | --- | --- | --- | --- | --- |\n");
  for (const int grid : a.grids) measure(context, a, grid, json["rows"]);
  if (!a.json.empty()) write_whole_file(a.json, json.dump(2) + "\n");
}

}  // namespace

void add_smoother(CLI::App& app) {
  auto* command = app.add_subcommand("smoother", "the smoother against plain C++ and a copy of memory");
  auto a = std::make_shared<Arguments>();
  command->add_option("--grids", a->grids, "cells along an edge")->delimiter(',')->capture_default_str();
  command->add_option("--runs", a->runs, "counted runs")->check(CLI::Range(1, 1000))->capture_default_str();
  command->add_option("--device", a->device, "part of the Vulkan device's name");
  command->add_option("--json", a->json, "results (JSON)");
  command->callback([a] { run_smoother(*a); });
}

}  // namespace alabaster

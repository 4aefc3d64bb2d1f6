// alabaster-bench: how long things take. Medians of several runs; quote ratios measured in one run.
#include "bench.h"
#include "run_app.h"

int main(int argc, char** argv) {
  CLI::App app("Benchmarks of Alabaster: medians of several runs.", "alabaster-bench");
  app.require_subcommand(1);
  alabaster::add_stages(app);
  alabaster::add_components(app);
  alabaster::add_accuracy(app);
  alabaster::add_smoother(app);
  alabaster::add_solver(app);
  alabaster::add_peers(app);
  return alabaster::run_app(app, argc, argv);
}

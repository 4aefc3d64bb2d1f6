// alabaster-bench: how long things take. Medians of several runs; quote ratios measured in one run.
#include <cstdio>
#include <exception>

#include "bench.h"

int main(int argc, char** argv) {
  CLI::App app("Benchmarks of Alabaster: medians of several runs.", "alabaster-bench");
  app.require_subcommand(1);
  alabaster::add_stages(app);
  alabaster::add_components(app);
  alabaster::add_accuracy(app);
  alabaster::add_smoother(app);
  alabaster::add_solver(app);
  alabaster::add_peers(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "alabaster-bench: %s\n", e.what());
    return 1;
  }
  return 0;
}

// alabaster: the command line. Exit status 0 done, 1 failed (one line on stderr), 2 wrong usage.
#include <cstdio>
#include <exception>

#include "commands.h"

int main(int argc, char** argv) {
  CLI::App app("Translucent, heterogeneous solids from the diffusion equation, and the proof that they are right.",
               "alabaster");
  app.require_subcommand(1);
  alabaster::add_render(app);
  alabaster::add_reference(app);
  alabaster::add_compare(app);
  alabaster::add_merge(app);
  alabaster::add_inspect(app);
  alabaster::add_devices(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "alabaster: %s\n", e.what());
    return 1;
  }
  return 0;
}

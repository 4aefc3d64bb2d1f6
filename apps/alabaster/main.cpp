// alabaster: the command line. Exit status 0 done, 1 failed (one line on stderr), 2 wrong usage.
#include <malloc.h>

#include "commands.h"
#include "run_app.h"

int main(int argc, char** argv) {
  // Large blocks go back to the system when they are freed. Left alone, glibc keeps up to 64 MiB of them and more in
  // pieces: a twentieth of the peak at 128^3, more in some runs than in others.
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
  mallopt(M_TRIM_THRESHOLD, 16 << 20);
  CLI::App app("Translucent, heterogeneous solids from the diffusion equation, and the proof that they are right.",
               "alabaster");
  app.require_subcommand(1);
  alabaster::add_render(app);
  alabaster::add_reference(app);
  alabaster::add_compare(app);
  alabaster::add_merge(app);
  alabaster::add_inspect(app);
  alabaster::add_devices(app);
  return alabaster::run_app(app, argc, argv);
}

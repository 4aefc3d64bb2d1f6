// What every main does with its arguments.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

namespace alabaster {

/// Runs what the arguments ask for. Returns the exit status: 0 done, 1 failed (one line on stderr), 2 wrong usage.
inline int run_app(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s: %s\n", app.get_name().c_str(), e.what());
    return 1;
  }
  return 0;
}

}  // namespace alabaster

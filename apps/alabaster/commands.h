// One function a subcommand: adds its options to the command line and says what to run.
#pragma once

#include <CLI/CLI.hpp>

namespace alabaster {

void add_render(CLI::App& app);
void add_reference(CLI::App& app);
void add_compare(CLI::App& app);
void add_merge(CLI::App& app);
void add_inspect(CLI::App& app);
void add_devices(CLI::App& app);

}  // namespace alabaster

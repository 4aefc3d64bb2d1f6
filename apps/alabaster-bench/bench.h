// Medians of repeated measurements, and the tables and JSON they are shown in. One function a subcommand.
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <vector>

namespace alabaster {

inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

void add_stages(CLI::App& app);
void add_components(CLI::App& app);
void add_accuracy(CLI::App& app);
void add_solver(CLI::App& app);
void add_smoother(CLI::App& app);
void add_peers(CLI::App& app);

}  // namespace alabaster

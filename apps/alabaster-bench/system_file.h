// A linear system in a file, for other people's solvers: int32 n[3], then for every cell (x fastest) the doubles of its
// faces towards lower x, y, z, its reaction and its right-hand side. Cells that are none have only zeros.
#pragma once

#include <array>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace alabaster {

struct LinearSystem {
  std::array<std::int32_t, 3> n{0, 0, 0};
  std::vector<double> values;  // five a cell

  static constexpr int entries = 5;
  std::size_t cells() const { return std::size_t(n[0]) * n[1] * n[2]; }
  const double* at(std::size_t cell) const { return &values[entries * cell]; }

  void write(const std::string& path) const {
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(n.data()), sizeof n);
    file.write(reinterpret_cast<const char*>(values.data()),
               static_cast<std::streamsize>(values.size() * sizeof(double)));
  }
  static LinearSystem read(const std::string& path) {
    LinearSystem system;
    std::ifstream file(path, std::ios::binary);
    file.read(reinterpret_cast<char*>(system.n.data()), sizeof system.n);
    system.values.resize(entries * system.cells());
    file.read(reinterpret_cast<char*>(system.values.data()),
              static_cast<std::streamsize>(system.values.size() * sizeof(double)));
    return system;
  }
};

}  // namespace alabaster

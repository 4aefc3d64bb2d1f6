// What the smoother is measured against: the same sweep in plain C++ for all cores, and a copy of memory.
#pragma once

#include <cstddef>

namespace alabaster {

/// A seven-point system of n^3 cells with a ghost layer, (n + 2)^3 values an array, x fastest.
struct PlainSystem {
  int n;
  const float *face_x, *face_y, *face_z, *reaction, *inverse_l1, *b;
};

/// to = from + omega inverse_l1 (b - A from), OpenMP over slices, vectorised along x.
void plain_sweep(const PlainSystem& system, float omega, const float* from, float* to);

/// STREAM's copy, OpenMP.
void plain_copy(const float* from, float* to, std::size_t count);

}  // namespace alabaster

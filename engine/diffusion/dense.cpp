#include "diffusion/dense.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace alabaster {
namespace {

using Profile = std::vector<int>;  // each row's first column that is not zero; the factor has none before it either

Profile profile_of(const std::vector<double>& a, int n) {
  Profile first(n);
  for (int r = 0; r < n; ++r)
    while (first[r] < r && a[std::size_t(r) * n + first[r]] == 0) ++first[r];
  return first;
}

// Lower Cholesky factor in place; a pivot below `rank_tolerance` leaves a zero column.
void factor(std::vector<double>& a, int n, const Profile& first, double rank_tolerance) {
  for (int c = 0; c < n; ++c) {
    double* pivot_row = &a[std::size_t(c) * n];
    double pivot = pivot_row[c];
    for (int k = first[c]; k < c; ++k) pivot -= pivot_row[k] * pivot_row[k];
    const double root = pivot > rank_tolerance ? std::sqrt(pivot) : 0.0;
    pivot_row[c] = root;
    for (int r = c + 1; r < n; ++r) {
      if (first[r] > c) continue;
      double* row = &a[std::size_t(r) * n];
      double sum = row[c];
      for (int k = std::max(first[r], first[c]); k < c; ++k) sum -= row[k] * pivot_row[k];
      row[c] = root > 0 ? sum / root : 0.0;
    }
  }
}

// Solves L L^T y = e_column, with zeros for the columns left out.
void solve_unit(const std::vector<double>& l, int n, const Profile& first, int column, std::vector<double>& y) {
  for (int r = 0; r < n; ++r) {
    const double* row = &l[std::size_t(r) * n];
    double sum = r == column ? 1.0 : 0.0;
    for (int k = std::max(column, first[r]); k < r; ++k) sum -= row[k] * y[k];
    y[r] = r >= column && row[r] > 0 ? sum / row[r] : 0.0;
  }
  for (int r = n - 1; r >= 0; --r) {
    const double* row = &l[std::size_t(r) * n];
    y[r] = row[r] > 0 ? y[r] / row[r] : 0.0;
    for (int k = first[r]; k < r; ++k) y[k] -= row[k] * y[r];
  }
}

}  // namespace

std::vector<double> invert_spd(std::vector<double> matrix, int n, double rank_tolerance) {
  std::vector<double> scale(n), inverse(matrix.size(), 0.0);
  for (int r = 0; r < n; ++r) {
    const double d = matrix[std::size_t(r) * n + r];
    scale[r] = d > 0 ? 1 / std::sqrt(d) : 0.0;
  }
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; ++c) matrix[std::size_t(r) * n + c] *= scale[r] * scale[c];
  const Profile first = profile_of(matrix, n);
  factor(matrix, n, first, rank_tolerance);
  tbb::parallel_for(0, n, [&](int column) {
    if (matrix[std::size_t(column) * n + column] <= 0) return;
    std::vector<double> y(n);
    solve_unit(matrix, n, first, column, y);
    for (int r = 0; r < n; ++r) inverse[std::size_t(r) * n + column] = y[r] * scale[r] * scale[column];
  });
  return inverse;
}

}  // namespace alabaster

// The direct solve of the coarsest level.
#pragma once

#include <vector>

namespace alabaster {

/// Inverse of a symmetric positive semi-definite matrix (row-major, n x n) by Cholesky in double precision, symmetric
/// and positive itself. Rows without a diagonal, and unknowns that repeat others to rounding (`rank_tolerance`,
/// relative to the scaled diagonal), get zero rows and columns: as a preconditioner it then leaves them to the
/// smoother.
std::vector<double> invert_spd(std::vector<double> matrix, int n, double rank_tolerance);

}  // namespace alabaster

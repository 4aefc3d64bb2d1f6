// Solves a system that `alabaster-bench peers` wrote with hypre: alabaster-hypre pfmg|boomeramg FILE, under mpirun.
// Rank 0 prints milliseconds, iterations and the residual as JSON. A benchmark only: built where hypre and MPI are
// found.
#include <HYPRE.h>
#include <HYPRE_krylov.h>
#include <HYPRE_parcsr_ls.h>
#include <HYPRE_struct_ls.h>
#include <mpi.h>

#include <cstdio>
#include <string>

#include "alabaster-bench/system_file.h"

namespace {

using alabaster::LinearSystem;

constexpr double tolerance = 1e-6;
constexpr int most_iterations = 500;

struct Result {
  double setup_ms = 0, solve_ms = 0, residual = 0;
  int iterations = 0;
};

// This rank's slices of the grid.
struct Share {
  int rank, first, last;
};

Share share_of(const LinearSystem& system) {
  int rank = 0, ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  return {rank, system.n[2] * rank / ranks, system.n[2] * (rank + 1) / ranks - 1};
}

// Milliseconds of `work`, the slowest rank's.
template <class Work>
double timed(Work work) {
  MPI_Barrier(MPI_COMM_WORLD);
  const double start = MPI_Wtime();
  work();
  MPI_Barrier(MPI_COMM_WORLD);
  return 1e3 * (MPI_Wtime() - start);
}

std::size_t step(const LinearSystem& s, int axis) {
  return axis == 0 ? 1 : axis == 1 ? std::size_t(s.n[0]) : std::size_t(s.n[0]) * s.n[1];
}

double diagonal(const LinearSystem& s, std::size_t cell) {
  double sum = s.at(cell)[3];
  for (int axis = 0; axis < 3; ++axis) {
    sum += s.at(cell)[axis];
    if (cell + step(s, axis) < s.cells()) sum += s.at(cell + step(s, axis))[axis];
  }
  return sum;
}

// Conjugate gradients preconditioned by PFMG on the whole box; cells outside are rows of the unit matrix.
Result pfmg(const LinearSystem& s) {
  const Share share = share_of(s);
  int low[3] = {0, 0, share.first}, high[3] = {s.n[0] - 1, s.n[1] - 1, share.last};
  int offsets[4][3] = {{0, 0, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}, entries[4] = {0, 1, 2, 3};
  HYPRE_StructGrid grid;
  HYPRE_StructGridCreate(MPI_COMM_WORLD, 3, &grid);
  HYPRE_StructGridSetExtents(grid, low, high);
  HYPRE_StructGridAssemble(grid);
  HYPRE_StructStencil stencil;
  HYPRE_StructStencilCreate(3, 4, &stencil);
  for (int k = 0; k < 4; ++k) HYPRE_StructStencilSetElement(stencil, k, offsets[k]);
  HYPRE_StructMatrix matrix;
  HYPRE_StructMatrixCreate(MPI_COMM_WORLD, grid, stencil, &matrix);
  HYPRE_StructMatrixSetSymmetric(matrix, 1);
  HYPRE_StructMatrixInitialize(matrix);
  HYPRE_StructVector b, x;
  for (HYPRE_StructVector* v : {&b, &x}) {
    HYPRE_StructVectorCreate(MPI_COMM_WORLD, grid, v);
    HYPRE_StructVectorInitialize(*v);
  }
  const std::size_t first = share.first * step(s, 2), last = (share.last + 1) * step(s, 2);
  std::vector<double> values, rhs, zero(last - first, 0.0);
  for (std::size_t cell = first; cell < last; ++cell) {
    const double d = diagonal(s, cell);
    values.push_back(d > 0 ? d : 1.0);
    for (int axis = 0; axis < 3; ++axis) values.push_back(-s.at(cell)[axis]);
    rhs.push_back(s.at(cell)[4]);
  }
  HYPRE_StructMatrixSetBoxValues(matrix, low, high, 4, entries, values.data());
  HYPRE_StructMatrixAssemble(matrix);
  HYPRE_StructVectorSetBoxValues(b, low, high, rhs.data());
  HYPRE_StructVectorSetBoxValues(x, low, high, zero.data());
  HYPRE_StructVectorAssemble(b);
  HYPRE_StructVectorAssemble(x);
  HYPRE_StructSolver solver, cycle;
  HYPRE_StructPFMGCreate(MPI_COMM_WORLD, &cycle);
  HYPRE_StructPFMGSetMaxIter(cycle, 1);
  HYPRE_StructPFMGSetTol(cycle, 0.0);
  HYPRE_StructPFMGSetZeroGuess(cycle);
  HYPRE_StructPFMGSetRelaxType(cycle, 2);  // symmetric red-black Gauss-Seidel
  HYPRE_StructPCGCreate(MPI_COMM_WORLD, &solver);
  HYPRE_StructPCGSetTol(solver, tolerance);
  HYPRE_StructPCGSetTwoNorm(solver, 1);
  HYPRE_StructPCGSetMaxIter(solver, most_iterations);
  HYPRE_StructPCGSetPrecond(solver, HYPRE_StructPFMGSolve, HYPRE_StructPFMGSetup, cycle);
  Result result;
  result.setup_ms = timed([&] { HYPRE_StructPCGSetup(solver, matrix, b, x); });
  result.solve_ms = timed([&] { HYPRE_StructPCGSolve(solver, matrix, b, x); });
  HYPRE_StructPCGGetNumIterations(solver, &result.iterations);
  HYPRE_StructPCGGetFinalRelativeResidualNorm(solver, &result.residual);
  return result;
}

// Conjugate gradients preconditioned by BoomerAMG with aggressive coarsening, on the object's cells alone.
Result boomeramg(const LinearSystem& s) {
  const Share share = share_of(s);
  std::vector<int> number(s.cells(), -1);
  int count = 0, first = 0, last = -1;
  for (std::size_t cell = 0; cell < s.cells(); ++cell) {
    const int z = static_cast<int>(cell / step(s, 2));
    if (cell == share.first * step(s, 2)) first = count;
    if (diagonal(s, cell) > 0) number[cell] = count++;
    if (z <= share.last) last = count - 1;
  }
  HYPRE_IJMatrix matrix;
  HYPRE_IJMatrixCreate(MPI_COMM_WORLD, first, last, first, last, &matrix);
  HYPRE_IJMatrixSetObjectType(matrix, HYPRE_PARCSR);
  HYPRE_IJMatrixInitialize(matrix);
  HYPRE_IJVector b, x;
  for (HYPRE_IJVector* v : {&b, &x}) {
    HYPRE_IJVectorCreate(MPI_COMM_WORLD, first, last, v);
    HYPRE_IJVectorSetObjectType(*v, HYPRE_PARCSR);
    HYPRE_IJVectorInitialize(*v);
  }
  for (std::size_t cell = 0; cell < s.cells(); ++cell) {
    int row = number[cell];
    if (row < first || row > last) continue;
    int columns[7] = {row}, used = 1;
    double values[7] = {diagonal(s, cell)};
    for (int axis = 0; axis < 3; ++axis)
      for (const bool up : {false, true}) {
        const std::size_t other = up ? cell + step(s, axis) : cell - step(s, axis);
        const double face = other < s.cells() ? s.at(up ? other : cell)[axis] : 0.0;
        if (face <= 0) continue;
        columns[used] = number[other];
        values[used++] = -face;
      }
    double rhs = s.at(cell)[4], zero = 0;
    HYPRE_IJMatrixSetValues(matrix, 1, &used, &row, columns, values);
    HYPRE_IJVectorSetValues(b, 1, &row, &rhs);
    HYPRE_IJVectorSetValues(x, 1, &row, &zero);
  }
  HYPRE_IJMatrixAssemble(matrix);
  HYPRE_IJVectorAssemble(b);
  HYPRE_IJVectorAssemble(x);
  void *matrix_object, *b_object, *x_object;
  HYPRE_IJMatrixGetObject(matrix, &matrix_object);
  HYPRE_IJVectorGetObject(b, &b_object);
  HYPRE_IJVectorGetObject(x, &x_object);
  const auto a = static_cast<HYPRE_ParCSRMatrix>(matrix_object);
  const auto rhs = static_cast<HYPRE_ParVector>(b_object), solution = static_cast<HYPRE_ParVector>(x_object);
  HYPRE_Solver solver, cycle;
  HYPRE_BoomerAMGCreate(&cycle);
  HYPRE_BoomerAMGSetMaxIter(cycle, 1);
  HYPRE_BoomerAMGSetTol(cycle, 0.0);
  HYPRE_BoomerAMGSetCoarsenType(cycle, 8);  // PMIS
  HYPRE_BoomerAMGSetInterpType(cycle, 6);   // extended + i
  HYPRE_BoomerAMGSetAggNumLevels(cycle, 1);
  HYPRE_BoomerAMGSetStrongThreshold(cycle, 0.5);
  HYPRE_BoomerAMGSetPMaxElmts(cycle, 4);
  HYPRE_BoomerAMGSetRelaxType(cycle, 6);  // symmetric hybrid Gauss-Seidel
  HYPRE_BoomerAMGSetNumSweeps(cycle, 1);
  HYPRE_ParCSRPCGCreate(MPI_COMM_WORLD, &solver);
  HYPRE_PCGSetTol(solver, tolerance);
  HYPRE_PCGSetTwoNorm(solver, 1);
  HYPRE_PCGSetMaxIter(solver, most_iterations);
  HYPRE_ParCSRPCGSetPrecond(solver, HYPRE_BoomerAMGSolve, HYPRE_BoomerAMGSetup, cycle);
  Result result;
  result.setup_ms = timed([&] { HYPRE_ParCSRPCGSetup(solver, a, rhs, solution); });
  result.solve_ms = timed([&] { HYPRE_ParCSRPCGSolve(solver, a, rhs, solution); });
  HYPRE_PCGGetNumIterations(solver, &result.iterations);
  HYPRE_PCGGetFinalRelativeResidualNorm(solver, &result.residual);
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  HYPRE_Init();
  int rank = 0, code = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  const std::string method = argc == 3 ? argv[1] : "";
  if (method != "pfmg" && method != "boomeramg") {
    if (rank == 0) std::fprintf(stderr, "usage: alabaster-hypre pfmg|boomeramg FILE\n");
    code = 2;
  } else {
    const LinearSystem system = LinearSystem::read(argv[2]);
    const Result r = method == "pfmg" ? pfmg(system) : boomeramg(system);
    if (rank == 0)
      std::printf("{\"setup_ms\": %.3f, \"solve_ms\": %.3f, \"iterations\": %d, \"residual\": %.3e}\n", r.setup_ms,
                  r.solve_ms, r.iterations, r.residual);
  }
  HYPRE_Finalize();
  MPI_Finalize();
  return code;
}

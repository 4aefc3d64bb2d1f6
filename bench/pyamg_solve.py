#!/usr/bin/env python3
"""Solves a system that `alabaster-bench peers` wrote with pyamg's Ruge-Stueben multigrid as a preconditioner of conjugate
gradients; prints milliseconds, iterations and the residual as JSON. pyamg_solve.py FILE | --available"""
import json
import sys
import time

import numpy as np
import pyamg
import scipy.sparse as sparse
from scipy.sparse.linalg import cg


def read(path):
    """The matrix and right-hand side of the object's cells (system_file.h)."""
    with open(path, "rb") as file:
        n = np.fromfile(file, np.int32, 3)
        values = np.fromfile(file, np.float64).reshape(-1, 5)
    cells = len(values)
    matrix = sparse.diags(values[:, 3]).tocsr()
    for axis, step in enumerate((1, n[0], n[0] * n[1])):
        upper = np.flatnonzero(values[:, axis] > 0)
        face = values[upper, axis]
        rows, columns = np.concatenate((upper, upper - step)), np.concatenate((upper - step, upper))
        coupling = sparse.coo_matrix((np.tile(face, 2), (rows, columns)), (cells, cells)).tocsr()
        matrix = matrix + sparse.diags(np.asarray(coupling.sum(1)).ravel()) - coupling
    inside = np.flatnonzero(matrix.diagonal() > 0)
    return matrix[inside][:, inside].tocsr(), values[inside, 4]


def main():
    if sys.argv[1] == "--available":
        print(json.dumps({"pyamg": pyamg.__version__}))
        return
    matrix, b = read(sys.argv[1])
    start = time.perf_counter()
    cycle = pyamg.ruge_stuben_solver(matrix, max_coarse=500).aspreconditioner()
    middle = time.perf_counter()
    iterations = 0

    def count(_):
        nonlocal iterations
        iterations += 1

    x, _ = cg(matrix, b, rtol=1e-6, maxiter=500, M=cycle, callback=count)
    end = time.perf_counter()
    residual = np.linalg.norm(b - matrix @ x) / np.linalg.norm(b)
    print(json.dumps({"setup_ms": 1e3 * (middle - start), "solve_ms": 1e3 * (end - middle), "iterations": iterations,
                      "residual": residual}))


main()

#!/usr/bin/env python3
"""Solves the matrix that `measure … export=FOLDER` wrote with PETSc's GAMG and with pyamg: `peers.py FOLDER [petsc|pyamg] …`.

Debian: python3-petsc4py. PyPI: pyamg. One thread; the tolerance is 1e-8 in the norm of the inverse preconditioner, as in `measure`.
"""

import resource
import sys
import time

import numpy as np


def read(folder):
    load = lambda name, kind: np.fromfile(f"{folder}/{name}", kind)
    starts, columns = load("starts", np.int32), load("columns", np.int32)
    values = load("values", float).reshape(-1, 3, 3)
    return starts, columns, values, load("points", float).reshape(-1, 3), load("force", float), load("held", np.uint8)


def reduced(folder):
    """The matrix of the nodes that are not held, as block CSR; held ones are held in all directions."""
    starts, columns, values, points, force, held = read(folder)
    free = np.flatnonzero(held.reshape(-1, 3)[:, 0] == 0)
    place = -np.ones(len(points), int)
    place[free] = np.arange(len(free))
    rows = np.repeat(np.arange(len(points)), np.diff(starts))
    kept = (place[rows] >= 0) & (place[columns] >= 0)
    counts = np.bincount(place[rows[kept]], minlength=len(free))
    new = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
    blocks = (new, place[columns[kept]].astype(np.int32), values[kept])
    return blocks, points[free], force.reshape(-1, 3)[free].ravel()


def rigid(points):
    x, y, z = (points - points.mean(axis=0)).T
    b = np.zeros((len(points), 3, 6))
    b[:, 0, 0] = b[:, 1, 1] = b[:, 2, 2] = 1
    b[:, 1, 3], b[:, 2, 3] = -z, y
    b[:, 2, 4], b[:, 0, 4] = -x, z
    b[:, 0, 5], b[:, 1, 5] = -y, x
    return b.reshape(-1, 6)


def tell(n, setup, iterations, solve, residual):
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    return f"{n} unknowns, setup {setup:.2f} s, {iterations} iterations {solve:.2f} s, residual {residual:.1e}, peak {peak:.2f} GB"


def petsc(folder):
    """Unknowns, seconds of the setup, iterations, their seconds, residual."""
    import petsc4py

    petsc4py.init([])
    from petsc4py import PETSc

    (starts, columns, values), points, b = reduced(folder)
    n = len(b)
    m = PETSc.Mat().createBAIJ((n, n), 3, csr=(starts, columns, values.ravel()), comm=PETSc.COMM_SELF)
    del starts, columns, values
    m.setOption(PETSc.Mat.Option.SPD, True)
    m = m.convert("aij")
    m.setBlockSize(3)
    coordinates = PETSc.Vec().createWithArray(points.ravel().copy(), bsize=3, comm=PETSc.COMM_SELF)
    m.setNearNullSpace(PETSc.NullSpace().createRigidBody(coordinates))
    ksp = PETSc.KSP().create(comm=PETSc.COMM_SELF)
    ksp.setOperators(m)
    ksp.setType("cg")
    ksp.setNormType(PETSc.KSP.NormType.NATURAL)
    ksp.getPC().setType("gamg")
    ksp.setTolerances(rtol=1e-8, max_it=500)
    ksp.setFromOptions()
    x, f = m.createVecRight(), PETSc.Vec().createWithArray(b, comm=PETSc.COMM_SELF)
    start = time.process_time()
    ksp.setUp()
    setup = time.process_time() - start
    start = time.process_time()
    ksp.solve(f, x)
    solve = time.process_time() - start
    residual = (f - m * x).norm() / f.norm()
    return n, setup, ksp.getIterationNumber(), solve, residual


def pyamg(folder):
    """The same."""
    import pyamg as amg
    from scipy.sparse import bsr_matrix

    (starts, columns, values), points, b = reduced(folder)
    a = bsr_matrix((values, columns, starts), shape=(len(b), len(b)))
    start = time.process_time()
    ml = amg.smoothed_aggregation_solver(a, B=rigid(points), symmetry="symmetric", strength=("symmetric", {"theta": 0.0}), max_coarse=300)
    setup = time.process_time() - start
    start, count = time.process_time(), []
    m = ml.aspreconditioner(cycle="V")
    from pyamg.krylov import cg

    x, _ = cg(a, b, M=m, tol=1e-8, criteria="rMr", maxiter=500, residuals=count)
    solve = time.process_time() - start
    return a.shape[0], setup, len(count) - 1, solve, np.linalg.norm(b - a @ x) / np.linalg.norm(b)


if __name__ == "__main__":
    for name in sys.argv[2:] or ["petsc", "pyamg"]:
        print(f"{name}: {tell(*{'petsc': petsc, 'pyamg': pyamg}[name](sys.argv[1]))}")

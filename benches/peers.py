"""What other programs take for the work of `cargo bench --bench peers`: `peers.py WORK FOLDER` prints seconds of the processor, seconds of
the clock, and a number that both must agree in. One thread.

FOLDER holds raw arrays: points, cells, and the stiffness in blocks as `crates/multigrid/benches/peers.py` reads it.
"""

import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "crates/multigrid/benches"))
import peers as multigrid


class Clock:
    def __enter__(self):
        self.processor, self.wall = time.process_time(), time.perf_counter()
        return self

    def __exit__(self, *_):
        self.processor, self.wall = time.process_time() - self.processor, time.perf_counter() - self.wall


def version(name):
    from importlib.metadata import version

    return version(name)


def assembly(folder):
    """The stiffness of linear hexahedra by scikit-fem; `Σ_ij (1 + i mod 7) K_ij (1 + j mod 5)`."""
    import skfem
    from skfem.models.elasticity import lame_parameters, linear_elasticity

    points = np.fromfile(f"{folder}/points").reshape(-1, 3)
    cells = np.fromfile(f"{folder}/cells", np.int64).reshape(-1, 8)
    # scikit-fem's nodes: (1,1,1), (1,1,0), (1,0,1), (0,1,1), (1,0,0), (0,1,0), (0,0,1), (0,0,0).
    order = [6, 2, 5, 7, 1, 3, 4, 0]
    mesh = skfem.MeshHex(points.T, cells[:, order].T, validate=False)
    form = linear_elasticity(*lame_parameters(1e4, 0.3))
    with Clock() as clock:
        basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementHex1()), intorder=3)
        matrix = form.assemble(basis)
    # Its unknowns are those of the points, which it may have put in another order.
    place = basis.nodal_dofs.T.ravel()
    i = np.arange(len(place))
    u, v = np.zeros(len(place)), np.zeros(len(place))
    u[place], v[place] = 1 + i % 7, 1 + i % 5
    return clock, u @ (matrix @ v), f"scikit-fem {version('scikit-fem')}"


def factor(folder):
    """The Cholesky factor of the free unknowns and one solution by CHOLMOD; the largest displacement."""
    import cvxopt
    from cvxopt import cholmod
    from scipy.sparse import bsr_matrix

    (starts, columns, values), _, force = multigrid.reduced(folder)
    matrix = bsr_matrix((values, columns, starts), shape=(len(force), len(force))).tocoo()
    lower = matrix.row >= matrix.col
    i, j, x = (cvxopt.matrix(a[lower]) for a in (matrix.row.astype(np.int64), matrix.col.astype(np.int64), matrix.data))
    matrix = cvxopt.spmatrix(x, i, j, (len(force), len(force)))
    u = cvxopt.matrix(force)
    with Clock() as clock:
        found = cholmod.symbolic(matrix)
        cholmod.numeric(matrix, found)
        cholmod.solve(found, u)
    return clock, np.abs(np.array(u)).max(), f"CHOLMOD of cvxopt {version('cvxopt')}"


def iterations(solver, name):
    def run(folder):
        with Clock() as clock:
            _, setup, count, solve, residual = solver(folder)
        # Without reading and converting the matrix.
        clock.wall *= (setup + solve) / clock.processor
        clock.processor = setup + solve
        if residual > 1e-5:
            raise RuntimeError(f"it left a residual of {residual:.1e}")
        return clock, count, f"{name}, {count} iterations"

    return run


    return ".".join(map(str, PETSc.Sys.getVersion()))


WORK = {
    "assembly": assembly,
    "factor": factor,
    "petsc": iterations(multigrid.petsc, "PETSc GAMG"),
    "pyamg": iterations(multigrid.pyamg, "pyamg"),
}

if __name__ == "__main__":
    clock, number, name = WORK[sys.argv[1]](sys.argv[2])
    print(f"{clock.processor}\t{clock.wall}\t{float(number)!r}\t{name}")

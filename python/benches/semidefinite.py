"""The spectral fit beside Clarabel's semidefinite cone: agreement, and time per element type: python semidefinite.py [SHAPES].

Needs clarabel==0.11.1 and scipy. Random shapes of each shipped linear element are fitted on one thread. The exit code is 1 if the two optima
differ by more than 1e-6, if a proved gap exceeds 1e-8, or if a general optimiser goes below the proved bound.
"""

import os

# Both count the time of one thread. Pools of threads read this once.
os.environ.update(RAYON_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")

import argparse
import sys
import tempfile
import time
from pathlib import Path

import clarabel
import numpy as np
from scipy.sparse import csc_matrix

MODULI = {"young": 1e4, "poisson": 0.3}
#: How far apart the cells of a file are, m; each is some 4 m large.
APART = 8.0
#: The types of VTK's cells of two and three dimensions whose nodes are corners alone: beyond them the general cone takes minutes.
LINEAR = (5, 7, 9, 10, 12, 13, 14)
#: Shapes of which a general optimiser searches the optimum, and its iterations.
FEW, ITERATIONS = 5, 2000


def triangle(matrix):
    """The upper triangle by columns, entries beside the diagonal times √2."""
    columns, rows = np.tril_indices(len(matrix))
    return np.where(rows == columns, 1.0, np.sqrt(2.0)) * matrix[rows, columns]


def conic(r, gradients, nonnegative):
    """``min t`` with ``t I ± (R − Σ k_s g_s g_sᵀ) ⪰ 0``, R scaled to one: the optimum in the units of R, None without one, and the time, s."""
    p, m = len(r), len(gradients)
    size = np.trace(r) / p
    springs = [triangle(np.outer(g, g)) / (g @ g) for g in gradients]
    # s = b − A (k, t) = t I ∓ R ± Σ k g gᵀ
    blocks = [np.column_stack([*(-sign * spring for spring in springs), -triangle(np.eye(p))]) for sign in (1, -1)]
    b = [-sign * triangle(r) / size for sign in (1, -1)]
    cones = [clarabel.PSDTriangleConeT(p), clarabel.PSDTriangleConeT(p)]
    if nonnegative:
        blocks.append(-np.eye(m, m + 1))
        b.append(np.zeros(m))
        cones.append(clarabel.NonnegativeConeT(m))
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    matrices = csc_matrix((m + 1, m + 1)), np.eye(m + 1)[m], csc_matrix(np.concatenate(blocks)), np.concatenate(b)
    start = time.perf_counter()
    solution = clarabel.DefaultSolver(*matrices, cones, settings).solve()
    seconds = time.perf_counter() - start
    solved = solution.status in (clarabel.SolverStatus.Solved, clarabel.SolverStatus.AlmostSolved)
    return (size * solution.x[m] if solved else None), seconds


def reduced(r, gradients):
    """R and the g_s on an orthonormal basis of the deformations, from the eigenvectors of R."""
    values, vectors = np.linalg.eigh(r)
    kept = values > 1e-9 * values[-1]
    return np.diag(values[kept]), [vectors[:, kept].T @ g for g in gradients]


def has_lengths(lists):
    """Whether the springs of a group are on lengths, between two nodes each."""
    return bool(lists) and all(len(nodes) == 2 for nodes in lists)


def norm(matrix):
    return np.abs(np.linalg.eigvalsh(matrix)).max()


class Body:
    """Cells of one element apart from each other, and the file of their mesh."""

    def __init__(self, element, shapes, folder, name):
        count, nodes, d = shapes.shape
        self.element, self.count, self.size = element, count, nodes * d
        points = shapes + APART * np.arange(count)[:, None, None] * np.eye(d)[0]
        number, order = element.vtk
        cells = np.empty((count, nodes), int)
        cells[:, order] = np.arange(count * nodes).reshape(count, nodes)
        space = np.zeros((count * nodes, 3))
        space[:, :d] = points.reshape(-1, d)
        lines = ["# vtk DataFile Version 3.0", "cells apart", "ASCII", "DATASET UNSTRUCTURED_GRID"]
        lines += [f"POINTS {len(space)} double", *(" ".join(map(repr, row)) for row in space.tolist())]
        lines += [f"CELLS {count} {count * (nodes + 1)}", *(f"{nodes} {' '.join(map(str, row))}" for row in cells.tolist())]
        lines += [f"CELL_TYPES {count}", *[str(number)] * count, ""]
        self.file = Path(folder, f"{name}.vtk")
        self.file.write_text("\n".join(lines))
        self.mesh = sf.Mesh.read(self.file)
        assert self.mesh.points.shape == (count * nodes, d) and self.mesh.cells[0][0] == element.name
        assert (self.mesh.cells[0][1] == np.arange(count * nodes).reshape(count, nodes)).all()
        self.points = self.mesh.points.reshape(count, nodes, d)
        self.material = sf.Material(**MODULI, plane="stress" if d == 2 else None)
        self.stiffness = self.each(sf.stiffness(self.mesh, self.material))
        self.groups = {group: self.gradients(group) for group in element.springs}

    def each(self, matrix):
        """The blocks of the cells, (cells, size, size)."""
        matrix, size = matrix.tocsr(), self.size
        return np.array([matrix[i : i + size, i : i + size].toarray() for i in range(0, self.count * size, size)])

    def gradients(self, group):
        """The gradients of what the springs of a group measure at rest, up to factors, (cells, springs, size)."""
        lists = self.element.springs[group]
        if not has_lengths(lists):
            # That of an area or a volume is a column of the stiffness k g gᵀ of a network of this spring alone.
            assert len(lists) <= 1, f"{self.element.name}: several springs on contents in one group"
            outer = self.each(sf.fit(self.mesh, self.material, "frobenius", springs=[group]).stiffness())
            return np.array([[matrix[np.argmax(matrix.diagonal())]] for matrix in outer])
        found = np.zeros((self.count, len(lists), *self.points.shape[1:]))
        for s, (a, b) in enumerate(lists):
            along = self.points[:, b] - self.points[:, a]
            along /= np.linalg.norm(along, axis=1, keepdims=True)
            found[:, s, a], found[:, s, b] = -along, along
        return found.reshape(self.count, len(lists), self.size)

    def values(self, groups, nonnegative, **keys):
        """``‖R − K‖₂`` of the spectral fit of each cell."""
        net = sf.fit(self.mesh, self.material, "spectral", springs=groups, nonnegative=nonnegative, **keys)
        return np.array([norm(e) for e in self.stiffness - self.each(net.stiffness())])

    def certified(self, groups, nonnegative):
        """The largest proved gap of the fit, and its time per cell, s, from the report of a scene."""
        fit = {"objective": "spectral", "springs": groups, "nonnegative": nonnegative}
        plane = {"plane": self.material.plane} if self.material.plane else {}
        scene = {"mesh": {"file": self.file.name}, "material": {**MODULI, **plane}, "fit": [fit]}
        record = sf.run(scene, folder=self.file.parent).record["fits"][0]
        return record["certificate_gap"], record["seconds_per_element"]


def random_shapes(element, count):
    """Reference cells under random affine maps, with each node moved by up to 7 % of their size; (count, nodes, dimension)."""
    rng = np.random.default_rng(2026)
    d, shapes = element.dimension, []
    positions = np.reshape(element.positions, (-1, d))
    for _ in range(100 * count):
        shape = positions @ (np.eye(d) + 0.4 * rng.uniform(-1, 1, (d, d))).T + 0.15 * rng.uniform(-1, 1, positions.shape)
        try:
            sf.Mesh(shape, {element.name: np.arange(len(shape))[None]})
        except sf.SpringfitError:
            # It is tangled.
            continue
        shapes.append(shape)
        if len(shapes) == count:
            return np.array(shapes)
    raise SystemExit(f"{element.name}: nearly every random shape tangles")


def compare(body, alone, groups, nonnegative):
    """Prints one row; whether the two agree, and nothing is below the proved bound."""
    # A spring on the content of the whole cell has no list of nodes.
    springs = sum(max(1, len(body.element.springs[group])) for group in groups)
    gap, native = body.certified(groups, nonnegative)
    values = body.values(groups, nonnegative)
    difference, seconds, solved = 0.0, 0.0, 0
    for i, r in enumerate(body.stiffness):
        g = np.concatenate([body.groups[group][i] for group in groups])
        optimum, own = conic(*reduced(r, g), nonnegative)
        seconds += own / body.count
        if optimum is not None:
            difference = max(difference, abs(optimum / values[i] - 1))
            solved += 1
    # What a general optimiser reaches, over the bound of each cell, which is its value less its own gap.
    above = []
    for one in alone:
        own, _ = one.certified(groups, nonnegative)
        bound = (1 - own) * one.values(groups, nonnegative)[0]
        searched = one.values(groups, nonnegative, solver="nelder-mead", iterations=ITERATIONS)[0]
        above.append(searched / bound - 1)
    print(
        f"{body.element.name:9} {springs:7} {nonnegative!s:6} {1e6 * native:12.2f} {1e6 * seconds:12.1f} {seconds / native:7.0f} "
        f"{difference:14.1e} {gap:12.1e} {min(above):9.1e} to mean {np.mean(above):.1e}",
        flush=True,
    )
    if solved < body.count:
        print(f"  Clarabel reported no solution for {body.count - solved} of {body.count}")
    return solved > 0 and difference <= 1e-6 and gap <= 1e-8 and min(above) > -1e-9


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("shapes", type=int, nargs="?", default=200, help="of each element")
    count = parser.parse_args().shapes
    print(f"{count} random elements each, one thread")
    print(
        f"{'element':9} {'springs':>7} {'k >= 0':6} {'native us':>12} {'Clarabel us':>12} {'ratio':>7} {'difference':>14} "
        f"{'largest gap':>12} {'Nelder-Mead above':>20}"
    )
    # The first solution loads the linear algebra.
    conic(np.eye(2), np.eye(2), False)
    agree = True
    with tempfile.TemporaryDirectory() as folder:
        for element in map(sf.Element, sf.shipped_elements()):
            if element.vtk is None or element.vtk[0] not in LINEAR:
                continue
            shapes = random_shapes(element, count)
            body = Body(element, shapes, folder, element.name)
            alone = [Body(element, shapes[i : i + 1], folder, f"{element.name}-{i}") for i in range(min(FEW, count))]
            every = list(element.springs)
            usual = [group for group in every if has_lengths(element.springs[group])]
            for groups in (usual, every):
                for nonnegative in (False, True):
                    agree &= compare(body, alone, groups, nonnegative)
    sys.exit(0 if agree else 1)


if __name__ == "__main__":
    import springfit as sf

    main()

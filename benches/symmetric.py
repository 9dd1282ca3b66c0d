"""The least error that any network on the points of a coarse mesh can have for a fine body, whatever its springs are.

Forces on the fine mesh become `g = Pᵀ f` on the coarse one, and displacements `u` are sampled at its points. A network answers `u = C g` with a
symmetric C, because its forces have an energy; the map of the body from g to u is not symmetric, because restriction and sampling are not the
transposes of each other. The symmetric C with the least `Σ ‖C g − u‖²/‖u‖²` over random loads is found in closed form, and printed with the
median error under loads that it has not seen, beside the finite elements of the coarse mesh. C need neither be positive nor sparse, so that networks
err more. The next columns are the best stiffness K = C⁻¹ that is positive definite and joins points of one cell, or points with up to one or two cells
between them, whatever its entries are: Gauss-Newton steps from the finite elements under the same loads, weighed by their errors as whole-object fits do.
Finite elements and loads are of this file alone: patches of traction and body forces that are linear in the position.

Usage: pip install gmsh numpy scipy; python benches/symmetric.py [--fine 2] [--loads 900] [--bodies "block with a hole, nu 0.3;..."]
"""

import argparse
import tempfile
from pathlib import Path

import gmsh
import numpy as np
import scipy.sparse as sp
from coarse import BODIES, mesh
from scipy.sparse.linalg import splu
from scipy.spatial import cKDTree

SUPPORTS = [["left"], ["left", "right"], ["bottom"]]
# The edges and faces of a tetrahedron with the order of the nodes of quadratic ones.
EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (2, 3), (1, 3)]
FACES = [(1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1)]
TESTED = 100
# Cells from a point to the farthest that a stiffness joins it to.
REACHES = [1, 2, 3]
STEPS, PRODUCTS = 12, 60


class Body:
    """The points, cells, boundary facets and groups of a mesh of tetrahedra of the first or second order."""

    def __init__(self, path):
        gmsh.initialize()
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(path))
        tags, points, _ = gmsh.model.mesh.getNodes()
        self.points = points.reshape(-1, 3)
        place = np.zeros(int(max(tags)) + 1, int)
        place[tags] = np.arange(len(tags))
        for kind, count in ((4, 4), (11, 10)):
            found, nodes = gmsh.model.mesh.getElementsByType(kind)
            if len(found):
                self.cells = place[nodes.reshape(-1, count).astype(int)]
        self.groups = {}
        for entity in gmsh.model.getPhysicalGroups(2):
            nodes, _ = gmsh.model.mesh.getNodesForPhysicalGroup(*entity)
            self.groups[gmsh.model.getPhysicalName(*entity)] = np.unique(place[nodes.astype(int)])
        gmsh.finalize()
        once = {}
        for cell in self.cells:
            for face in FACES:
                key = tuple(sorted(cell[list(face)]))
                sides = [next(i for i, edge in enumerate(EDGES) if set(edge) == {face[k], face[(k + 1) % 3]}) + 4 for k in range(3)]
                nodes = cell[list(face) + (sides if len(cell) == 10 else [])]
                once[key] = None if key in once else nodes
        self.facets = np.array([nodes for nodes in once.values() if nodes is not None])

    def free(self, groups):
        held = np.unique(np.concatenate([self.groups[group] for group in groups]))
        return np.setdiff1d(np.arange(self.points.size), (3 * held[:, None] + np.arange(3)).ravel())


def shapes(corners, count):
    """The functions of a tetrahedron at these coordinates of its corners, and their derivatives by the last three of them."""
    if count == 4:
        return np.array(corners), np.eye(4)[:, 1:] - np.eye(4)[:, :1]
    weights = np.array(corners)
    values = np.concatenate([weights * (2 * weights - 1), [4 * weights[a] * weights[b] for a, b in EDGES]])
    slopes = np.zeros((10, 4))
    slopes[range(4), range(4)] = 4 * weights - 1
    for row, (a, b) in enumerate(EDGES):
        slopes[4 + row, a], slopes[4 + row, b] = 4 * weights[b], 4 * weights[a]
    return values, slopes[:, 1:] - slopes[:, :1]


def rule(dimension, count):
    """Gauss points of a simplex by the collapsed cube: coordinates of the corners, and weights."""
    at, weight = np.polynomial.legendre.leggauss(count)
    at, weight = (at + 1) / 2, weight / 2
    for index in np.ndindex(*[count] * dimension):
        left, share, corners = 1.0, 1.0, []
        for level, i in enumerate(index):
            corners.append(at[i] * left)
            share *= weight[i] * (1 - at[i]) ** (dimension - 1 - level)
            left -= corners[-1]
        yield [left, *corners], share


def stiffness(body, poisson):
    """The stiffness of the finite elements with Young's modulus 1, and the volume that belongs to each point."""
    lame, shear = poisson / (1 + poisson) / (1 - 2 * poisson), 0.5 / (1 + poisson)
    cells, count = body.cells, body.cells.shape[1]
    local, volumes = np.zeros((len(cells), count, 3, count, 3)), np.zeros(len(body.points))
    for corners, weight in rule(3, 3):
        values, slopes = shapes(corners, count)
        jacobian = np.einsum("cna,nk->cak", body.points[cells], slopes)
        size = weight * np.linalg.det(jacobian)
        gradient = np.einsum("nk,cka->cna", slopes, np.linalg.inv(jacobian))
        local += np.einsum("c,cia,cjb->ciajb", lame * size, gradient, gradient)
        local += np.einsum("c,cib,cja->ciajb", shear * size, gradient, gradient)
        both = np.einsum("c,cik,cjk->cij", shear * size, gradient, gradient)
        for k in range(3):
            local[:, :, k, :, k] += both
        np.add.at(volumes, cells, size[:, None] * values)
    dofs = (3 * cells[:, :, None] + np.arange(3)).reshape(len(cells), -1)
    rows, columns = np.repeat(dofs, 3 * count, 1).ravel(), np.tile(dofs, (1, 3 * count)).ravel()
    return sp.coo_matrix((local.ravel(), (rows, columns)), shape=(body.points.size,) * 2).tocsc(), volumes


def random_loads(body, volumes, random, count):
    """Forces on the points, one column for each load."""
    corners = body.points[body.facets[:, :3]]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    # Quadratic facets have their forces at the middles of their sides, as constant tractions do.
    centres, nodes = corners.mean(1), body.facets[:, 3:]
    size, middle = np.ptp(body.points, axis=0).max(), body.points.mean(0)
    loads = np.zeros((body.points.size, count))
    for load in range(count):
        direction = random.uniform(-1, 1, 3)
        direction /= np.linalg.norm(direction)
        force = np.zeros_like(body.points)
        if load % 3 == 2:
            force += volumes[:, None] * (direction + (body.points - middle) / size @ random.uniform(-2, 2, (3, 3)))
        else:
            place, width = centres[random.integers(len(centres))], size * random.uniform(0.1, 0.5)
            share = areas * np.exp(-0.5 * np.sum((centres - place) ** 2, 1) / width**2)
            np.add.at(force, nodes, (share / 3)[:, None, None] * direction)
        loads[:, load] = force.ravel()
    return loads


def interpolation(points, body):
    """The matrix that takes displacements of the body's points to those at other points."""
    corners = body.points[body.cells[:, :4]]
    inverse = np.linalg.inv((corners[:, 1:] - corners[:, :1]).transpose(0, 2, 1))
    near = cKDTree(corners.mean(1)).query(points, min(60, len(corners)))[1]
    matrix = sp.lil_matrix((len(points), len(body.points)))
    for row, (point, cells) in enumerate(zip(points, near)):
        inside = np.einsum("cij,cj->ci", inverse[cells], point - corners[cells, 0])
        inside = np.c_[1 - inside.sum(1), inside]
        best = np.argmax(inside.min(1))
        matrix[row, body.cells[cells[best]]] = shapes(inside[best], body.cells.shape[1])[0]
    return sp.kron(matrix.tocsr(), sp.eye(3), format="csr")


def symmetric(start, forces, moved):
    """The symmetric C with the least `Σ ‖C g − u‖²/‖u‖²`, as near to the start as rounding allows."""
    sizes = np.linalg.norm(moved, axis=0)
    forces, lack = forces / sizes, (moved - start @ forces) / sizes
    values, vectors = np.linalg.eigh(forces @ forces.T)
    both = vectors.T @ lack @ forces.T @ vectors
    change = (both + both.T) / (values[:, None] + values + 2e-10 * values.max())
    return start + vectors @ change @ vectors.T


def joined(body, own, reach):
    """Which of the displacements `own` the points within so many cells of each other have."""
    count = len(body.points)
    corners = np.repeat(body.cells, 4, 1).ravel(), np.tile(body.cells, (1, 4)).ravel()
    beside = sp.csr_matrix((np.ones(len(corners[0])), corners), shape=(count, count))
    near = np.linalg.matrix_power((beside.toarray() > 0).astype(float), reach) > 0
    return np.kron(near, np.ones((3, 3), bool))[np.ix_(own, own)]


def positive(start, pattern, forces, moved):
    """The inverse of the positive definite K of this pattern with the least `Σ ln(1 + e²/m²)` of the errors e and their median m, from a start on."""
    rows, columns = np.nonzero(np.triu(pattern))
    root = np.sqrt(start.diagonal())
    scales, sizes = root[rows] * root[columns], np.linalg.norm(moved, axis=0)
    # Holds what no load sees.
    rho = 1e-6

    def stiffness(change):
        matrix = np.zeros_like(start)
        matrix[rows, columns] = change * scales
        return matrix + np.triu(matrix, 1).T

    def errors(answer):
        return np.linalg.norm(answer @ forces - moved, axis=0) / sizes

    change, answer = np.zeros(len(rows)), np.linalg.inv(start)
    for _ in range(STEPS):
        known = errors(answer)
        median = np.median(known)
        weights = np.sqrt(median**2 / (known**2 + median**2)) / sizes
        displaced = answer @ forces

        def along(step):
            return -(answer @ (stiffness(step) @ displaced)) * weights

        def back(residuals):
            both = (answer @ (residuals * weights)) @ displaced.T
            both = (both + both.T)[rows, columns] * scales
            return -np.where(rows == columns, both / 2, both)

        def objective(errors, change):
            return np.sum(np.log1p((errors / median) ** 2)) * median**2 + rho * change @ change

        left = -(back((displaced - moved) * weights) + rho * change)
        step, direction, size = np.zeros_like(left), left.copy(), left @ left
        first = size
        for _ in range(PRODUCTS):
            image = back(along(direction)) + rho * direction
            length = size / (direction @ image)
            step, left = step + length * direction, left - length * image
            last, size = size, left @ left
            if size < 1e-4 * first:
                break
            direction = left + size / last * direction
        before, length = objective(known, change), 1.0
        while length > 1e-3:
            tried = change + length * step
            matrix = start + stiffness(tried)
            values = np.linalg.eigvalsh(matrix)
            if values[0] > 0 and objective(errors(np.linalg.inv(matrix)), tried) < before:
                break
            length /= 2
        else:
            break
        change, answer = tried, np.linalg.inv(matrix)
    return answer


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--fine", type=float, default=2.0, help="size of the fine cells relative to that of coarse.py")
    options.add_argument("--loads", type=int, default=900, help="loads to which C is fitted: more than the coarse mesh has free displacements")
    options.add_argument("--bodies", default="cantilever, nu 0.3;block with a hole, nu 0.3", help="names, separated by semicolons")
    options = options.parse_args()
    reaches = " | ".join(f"{reach} cell{'s' if reach > 1 else ''}" for reach in REACHES)
    print(f"| body | held | finite elements | any symmetric answer | positive, within {reaches} |")
    print(f"|---|---|---|---{'|---' * len(REACHES)}|")
    for name in options.bodies.split(";"):
        kind, poisson, size, fine_size = BODIES[name]
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            mesh(kind, size, 1, folder / "coarse.msh")
            mesh(kind, options.fine * fine_size, 2, folder / "fine.msh")
            coarse, fine = Body(folder / "coarse.msh"), Body(folder / "fine.msh")
        of_coarse, of_fine, volumes = stiffness(coarse, poisson)[0], *stiffness(fine, poisson)
        restriction, sampling = interpolation(fine.points, coarse).T, interpolation(coarse.points, fine)
        loads = random_loads(fine, volumes, np.random.default_rng(1), options.loads + TESTED)
        for groups in SUPPORTS:
            free, own = fine.free(groups), coarse.free(groups)
            # Symmetric, so that the order needs no pivots.
            factor = splu(of_fine[free][:, free], permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
            moved = np.zeros_like(loads)
            moved[free] = factor.solve(np.ascontiguousarray(loads[free]))
            moved, forces = (sampling @ moved)[own], (restriction @ loads)[own]
            body = np.linalg.inv(of_coarse[own][:, own].toarray())
            best = symmetric(body, forces[:, TESTED:], moved[:, TESTED:])
            tested, known = forces[:, :TESTED], moved[:, :TESTED]
            answers = [body, best]
            for reach in REACHES:
                answers.append(positive(np.linalg.inv(body), joined(coarse, own, reach), forces[:, TESTED:], moved[:, TESTED:]))
            medians = [np.median(np.linalg.norm(answer @ tested - known, axis=0) / np.linalg.norm(known, axis=0)) for answer in answers]
            gains = " | ".join(f"{100 * median:.2f} ({medians[0] / median:.1f})" for median in medians[1:])
            print(f"| {name} | {', '.join(groups)} | {100 * medians[0]:.2f} | {gains} |", flush=True)


if __name__ == "__main__":
    main()

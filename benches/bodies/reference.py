"""Reference displacements of the bodies, by finite elements of scikit-fem (pip install scikit-fem meshio).

    python reference.py                write reference/BODY.json for every BODY.toml beside this script
    python reference.py --check        compare the files with a fresh solution
    python reference.py --springfit    compare the files with the finite elements of the module springfit

Nothing here is springfit's: meshio reads the mesh and its groups, scikit-fem assembles stiffness and loads, SciPy solves. The
stiffness of quadrilaterals and hexahedra is integrated by Gauss's rule of two points along each axis, as is usual.
"""
import argparse
import contextlib
import io
import json
import sys
import tomllib
from pathlib import Path

import meshio
import numpy as np
import skfem
from skfem.helpers import ddot, dot, eye, sym_grad, trace

FOLDER = Path(__file__).resolve().parent
# meshio's name of the cells, the name of the cells of the sides, and scikit-fem's mesh and element.
CELLS = {
    "triangle": ("line", skfem.MeshTri, skfem.ElementTriP1(), "tri3"),
    "quad": ("line", skfem.MeshQuad, skfem.ElementQuad1(), "quad4"),
    "tetra": ("triangle", skfem.MeshTet, skfem.ElementTetP1(), "tet4"),
    "hexahedron": ("quad", skfem.MeshHex, skfem.ElementHex1(), "hex8"),
}
# Corners of the cube in scikit-fem's order, as places in the usual one: one layer counterclockwise, then the other.
HEXAHEDRON = [0, 4, 3, 1, 7, 5, 2, 6]
# Larger differences are faults: two solvers of these systems agree to their rounding.
TOLERANCE = 1e-9


def read(scene):
    """The mesh of a scene: points in metres, cells, points of the groups."""
    with contextlib.redirect_stdout(io.StringIO()):  # it prints empty lines
        mesh = meshio.read(FOLDER / scene["mesh"]["file"])
    kind = next(kind for kind in ["hexahedron", "tetra", "quad", "triangle"] if any(block.type == kind for block in mesh.cells))
    sides, *_ = CELLS[kind]
    dimension = 3 if kind in ("hexahedron", "tetra") else 2
    cells = np.vstack([block.data for block in mesh.cells if block.type == kind])
    assert np.unique(cells).size == len(mesh.points), "points that belong to no cell"
    names = {(number, dim): name for name, (number, dim) in mesh.field_data.items()}
    groups = {}
    for block, marks in zip(mesh.cells, mesh.cell_data["gmsh:physical"]):
        for mark in np.unique(marks):
            name = names[mark, dimension if block.type == kind else dimension - 1]
            groups.setdefault(name, []).append(block.data[marks == mark].ravel())
    groups = {name: np.unique(np.concatenate(parts)) for name, parts in groups.items()}
    return mesh.points[:, :dimension] * scene["mesh"]["scale"], kind, cells, groups


def solve(scene):
    """What a body's file holds."""
    points, kind, cells, groups = read(scene)
    _, mesh_class, element, name = CELLS[kind]
    order = HEXAHEDRON if kind == "hexahedron" else slice(None)
    mesh = mesh_class(np.ascontiguousarray(points.T), np.ascontiguousarray(cells[:, order].T))
    material = scene["material"]
    young, poisson = material["young"], material["poisson"]
    mu, lam = young / (2 * (1 + poisson)), young * poisson / ((1 + poisson) * (1 - 2 * poisson))
    dimension = points.shape[1]
    thickness = 1.0
    if dimension == 2:
        assert material["plane"] == "stress"
        lam, thickness = 2 * lam * mu / (lam + 2 * mu), material["thickness"]

    @skfem.BilinearForm
    def stiffness(u, v, _):
        strain = sym_grad(u)
        return ddot(lam * eye(trace(strain), dimension) + 2 * mu * strain, sym_grad(v))

    vector = skfem.ElementVector(element)
    basis = skfem.Basis(mesh, vector, intorder=3)
    matrix = thickness * stiffness.assemble(basis)
    places = basis.nodal_dofs.T
    held = groups[scene["fix"][0]["group"]]
    loads = []
    for load in scene["load"]:
        if "traction" in load:
            inside = np.zeros(len(points), bool)
            inside[groups[load["group"]]] = True
            sides = [side for side in mesh.boundary_facets() if inside[mesh.facets[:, side]].all()]
            where, density = skfem.FacetBasis(mesh, vector, facets=np.array(sides), intorder=3), np.array(load["traction"], float)
        else:
            where, density = basis, np.array(load["body"], float)
        force = thickness * skfem.LinearForm(lambda v, w: dot(density[(...,) + (None,) * (v.ndim - 1)], v)).assemble(where)
        moved = skfem.solve(*skfem.condense(matrix, force, D=places[held].ravel()))
        loads.append({"name": load["name"], "forces": force[places].tolist(), "displacement": moved[places].tolist()})
    return {
        "format": "springfit benchmark body",
        "version": 1,
        "title": scene["title"],
        "source": f"scikit-fem {skfem.__version__}",
        "material": material,
        "element": name,
        "points": points.tolist(),
        "cells": cells.tolist(),
        "held": held.tolist(),
        "loads": loads,
    }


def text(body):
    """JSON with a line for each point, cell and load, so that changes are seen."""
    def value(v, deep):
        if isinstance(v, list) and v and isinstance(v[0], (list, dict)):
            inner = ",\n".join(" " * (deep + 1) + value(w, deep + 1) for w in v)
            return f"[\n{inner}\n{' ' * deep}]"
        if isinstance(v, dict) and deep:
            return "{" + ", ".join(f"{json.dumps(k)}: {value(w, deep)}" for k, w in v.items()) + "}"
        return json.dumps(v)

    return "{\n" + ",\n".join(f" {json.dumps(k)}: {value(v, 1)}" for k, v in body.items()) + "\n}\n"


def difference(known, moved):
    """The largest difference of two fields of displacements, as a share of the largest displacement."""
    known = np.asarray(known)
    return np.abs(known - moved).max() / np.linalg.norm(known, axis=1).max()


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--check", action="store_true", help="compare the files with a fresh solution")
    arguments.add_argument("--springfit", action="store_true", help="compare the files with the finite elements of springfit")
    options = arguments.parse_args()
    worst = 0.0
    for path in sorted(FOLDER.glob("*.toml")):
        scene = tomllib.loads(path.read_text())
        file = FOLDER / "reference" / f"{path.stem}.json"
        if not (options.check or options.springfit):
            file.write_text(text(solve(scene)))
            print(f"written: {file}")
            continue
        known = json.loads(file.read_text())
        if options.check:
            fresh = solve(scene)
            assert [fresh[k] for k in ("points", "cells", "held")] == [known[k] for k in ("points", "cells", "held")], file
            other = {load["name"]: np.array(load["displacement"]) for load in fresh["loads"]}
        else:
            import springfit

            # One cheap fit: its finite elements are wanted.
            report = springfit.run({**scene, "fit": [{"objective": "frobenius"}]}, folder=FOLDER)
            other = {name: fields[""] for name, fields in report.displacements.items()}
        for load in known["loads"]:
            found = difference(load["displacement"], other[load["name"]])
            worst = max(worst, found)
            print(f"{path.stem:14} {load['name']:8} {found:.1e}")
    if not worst < TOLERANCE:
        sys.exit(f"the largest difference is {worst:.1e} of the largest displacement; the limit is {TOLERANCE:.0e}")


if __name__ == "__main__":
    main()

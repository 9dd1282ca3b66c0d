"""Meshes of other packages as points, cells and groups. None of these packages is required."""

from __future__ import annotations

import os
import tempfile
from typing import Any

import numpy as np

from ._arguments import failure, matrix, places
from ._core import Element, shipped_elements

# meshio's names of the cells that VTK numbers; meshio keeps VTK's order of nodes.
_MESHIO = {
    "line": 3,
    "triangle": 5,
    "quad": 9,
    "tetra": 10,
    "hexahedron": 12,
    "wedge": 13,
    "pyramid": 14,
    "line3": 21,
    "triangle6": 22,
    "quad8": 23,
    "tetra10": 24,
    "hexahedron20": 25,
    "wedge15": 26,
    "pyramid13": 27,
    "quad9": 28,
    "hexahedron27": 29,
}

# Dimensions of VTK's cells: points, lines and cells of surfaces; others are solids.
_DIMENSION = {
    **dict.fromkeys((1, 2), 0),
    **dict.fromkeys((3, 4, 21, 35, 68, 75), 1),
    **dict.fromkeys((5, 6, 7, 8, 9, 22, 23, 28, 30, 32, 34, 36, 69, 70, 76, 77), 2),
}

# Pixels and voxels of VTK, whose nodes run along the axes, as quadrilaterals and hexahedra, whose nodes run around a face.
_AROUND = {8: (9, [0, 1, 3, 2]), 11: (12, [0, 1, 3, 2, 4, 5, 7, 6])}


def _elements(own: "list[Element]") -> "dict[int, tuple[Element, list[int]]]":
    """By the number of VTK's cell, with the place in VTK's list of each node; own elements before the shipped ones."""
    known: "dict[int, tuple[Element, list[int]]]" = {}
    for element in own + [Element(name) for name in shipped_elements()]:
        if element.vtk is not None:
            number, order = element.vtk
            known.setdefault(number, (element, order))
    return known


def _dimension(number: int) -> int:
    return _DIMENSION.get(number, 3)


def _blocks(cells: "list[tuple[int, Any]]", own: "list[Element]") -> "list[tuple[Element, np.ndarray]]":
    """Cells in VTK's order by the elements that serve them, in the order of the elements' nodes."""
    known = _elements(own)
    cells = [(_AROUND[n][0], nodes[:, _AROUND[n][1]]) if n in _AROUND and n not in known else (n, nodes) for n, nodes in cells]
    most = max((_dimension(number) for number, _ in cells), default=0)
    blocks = []
    for number, nodes in cells:
        if _dimension(number) == most:
            if number not in known:
                names = ", ".join(sorted({element.name for element, _ in known.values()}))
                raise failure("cells", f"cells of {names}", f"VTK's cell type {number}", "unsupported")
            element, order = known[number]
            key = f"cells of {element.name}"
            nodes = matrix(key, nodes, np.int64)
            if nodes.shape[1] != element.nodes:
                raise failure(key, f"cells of {element.nodes} nodes as {element.name} has", nodes.shape[1])
            blocks.append((element, nodes[:, order]))
    return blocks


def _space(points: np.ndarray, blocks: list) -> np.ndarray:
    """Without the third coordinate of a plane mesh."""
    points = matrix("points", points, np.float64)
    if blocks and blocks[0][0].dimension < 3 and points.shape[1] == 3:
        used = points[np.unique(np.concatenate([nodes.ravel() for _, nodes in blocks]))]
        extent = np.ptp(used, axis=0)
        if extent[2] <= 1e-9 * extent[:2].max():
            return points[:, :2]
    return points


def _join(groups: "dict[str, Any]", key: str, places: np.ndarray) -> None:
    """Adds places to a group, which may have others already."""
    groups[key] = np.union1d(groups[key], places) if key in groups else np.unique(places)


def from_meshio(mesh: Any, own: "list[Element]") -> tuple:
    cells: "list[tuple[int, np.ndarray]]" = []
    groups: "dict[str, Any]" = {}
    names = {tuple(np.atleast_1d(v)[:2]): name for name, v in (getattr(mesh, "field_data", None) or {}).items()}
    physical = (mesh.cell_data or {}).get("gmsh:physical", [None] * len(mesh.cells))
    for block, marks in zip(mesh.cells, physical):
        if block.type == "vertex":
            number = 1
        elif block.type in _MESHIO:
            number = _MESHIO[block.type]
        else:
            raise failure("cells", "cells of " + ", ".join(_MESHIO), block.type, "unsupported")
        nodes = matrix(f"cells of {block.type}", block.data, np.int64)
        cells.append((number, nodes))
        for mark in np.unique(marks) if marks is not None else []:
            name = names.get((mark, _dimension(number)))
            if name is not None:
                _join(groups, name, nodes[np.asarray(marks) == mark])
    for name, lists in (getattr(mesh, "cell_sets", None) or {}).items():
        # meshio keeps what else it has read of a Gmsh file under such names.
        if not name.startswith("gmsh:"):
            for (_, nodes), chosen in zip(cells, lists):
                if chosen is not None:
                    _join(groups, name, nodes[places(f"cell_sets.{name}", chosen, len(nodes), "cells of the block")])
    for name, chosen in (mesh.point_sets or {}).items():
        _join(groups, name, places(f"point_sets.{name}", chosen, len(mesh.points)))
    blocks = _blocks(cells, own)
    return _space(mesh.points, blocks), blocks, groups


def from_pyvista(grid: Any, own: "list[Element]") -> tuple:
    grid = grid.cast_to_unstructured_grid() if hasattr(grid, "cast_to_unstructured_grid") else grid
    try:
        cells = grid.cells_dict
    except ValueError as error:
        # Such as polyhedra.
        raise failure("cells", "cells that are lists of nodes", str(error), "unsupported") from error
    blocks = _blocks([(int(number), nodes) for number, nodes in cells.items()], own)
    return _space(grid.points, blocks), blocks, {}


def from_skfem(mesh: Any) -> tuple:
    # By the class, of which curved meshes are others.
    names = {"MeshLine1": "bar2", "MeshTri1": "tri3", "MeshQuad1": "quad4", "MeshTet1": "tet4", "MeshHex1": "hex8"}
    kind = type(mesh).__name__
    if kind not in names:
        raise failure("mesh", "one of " + ", ".join(names), kind, "unsupported")
    nodes = mesh.t.T
    groups: "dict[str, Any]" = {}
    for key, owners in (("boundaries", mesh.facets.T), ("subdomains", nodes)):
        for name, chosen in (getattr(mesh, key) or {}).items():
            _join(groups, name, owners[places(f"{key}.{name}", chosen, len(owners), key)])
    if kind == "MeshHex1":
        # Corners of the unit cube as scikit-fem numbers them, in VTK's order.
        nodes = nodes[:, [0, 3, 6, 2, 1, 5, 7, 4]]
    return mesh.p.T, {names[kind]: nodes}, groups


def from_gmsh(read: Any, scale: float, options: dict) -> Any:
    import gmsh

    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "model.msh")
        gmsh.write(path)
        return read(path, scale=scale, **options)

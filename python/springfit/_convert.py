"""Meshes of other packages as points, cells and groups. None of these packages is required."""

from __future__ import annotations

import os
import tempfile
from typing import Any

import numpy as np

from ._core import Element, SpringfitError, shipped_elements

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

# Dimensions of VTK's cells.
_DIMENSION = {3: 1, 21: 1, 5: 2, 9: 2, 22: 2, 23: 2, 28: 2}


def _error(key: str, expected: str, found: object, kind: str = "invalid") -> SpringfitError:
    error = SpringfitError(f"{key}: expected {expected}, found {found}")
    error.kind, error.file, error.line, error.key = kind, None, None, key
    return error


def _elements(own: list[Element]) -> dict[int, Element]:
    """By the number of VTK's cell; own elements before the shipped ones."""
    known: dict[int, Element] = {}
    for element in own + [Element(name) for name in shipped_elements()]:
        if element.vtk is not None:
            known.setdefault(element.vtk[0], element)
    return known


def _dimension(number: int) -> int:
    return 0 if number in (1, 2) else _DIMENSION.get(number, 3)


def _blocks(cells: list[tuple[int, np.ndarray]], own: list[Element]) -> list[tuple[Element, np.ndarray]]:
    """Cells in VTK's order by the elements that serve them, in the order of the elements' nodes."""
    most = max((_dimension(number) for number, _ in cells), default=0)
    known = _elements(own)
    blocks: dict[int, list[np.ndarray]] = {}
    for number, nodes in cells:
        if _dimension(number) == most:
            if number not in known:
                names = ", ".join(sorted({element.name for element in known.values()}))
                raise _error("cells", f"cells of {names}", f"VTK's cell type {number}", "unsupported")
            blocks.setdefault(number, []).append(np.asarray(nodes, dtype=np.int64))
    gathered = []
    for number, lists in blocks.items():
        element = known[number]
        nodes = np.concatenate(lists)
        if nodes.shape[1] != element.nodes:
            raise _error("cells", f"cells of {element.nodes} nodes as {element.name} has", nodes.shape[1])
        gathered.append((element, nodes[:, element.vtk[1]]))
    return gathered


def _space(points: np.ndarray, blocks: list) -> np.ndarray:
    """Without the third coordinate of a plane mesh."""
    points = np.asarray(points, dtype=np.float64)
    if blocks and blocks[0][0].dimension < 3 and points.shape[1] == 3:
        used = points[np.unique(np.concatenate([nodes.ravel() for _, nodes in blocks]))]
        extent = np.ptp(used, axis=0)
        if extent[2] <= 1e-9 * extent[:2].max():
            return points[:, :2]
    return points


def from_meshio(mesh: Any, own: list[Element]):
    cells, groups = [], {}
    names = {tuple(np.atleast_1d(v)[:2]): name for name, v in (getattr(mesh, "field_data", None) or {}).items()}
    physical = (mesh.cell_data or {}).get("gmsh:physical", [None] * len(mesh.cells))
    for block, marks in zip(mesh.cells, physical):
        if block.type == "vertex":
            number = 1
        elif block.type in _MESHIO:
            number = _MESHIO[block.type]
        else:
            raise _error("cells", "cells of " + ", ".join(_MESHIO), block.type, "unsupported")
        nodes = np.asarray(block.data)
        cells.append((number, nodes))
        for mark in np.unique(marks) if marks is not None else []:
            name = names.get((mark, _dimension(number)))
            if name is not None:
                chosen = nodes[np.asarray(marks) == mark].ravel()
                groups[name] = np.union1d(groups.get(name, []), chosen).astype(np.int64)
    for name, places in (mesh.point_sets or {}).items():
        groups[name] = np.asarray(places, dtype=np.int64)
    blocks = _blocks(cells, own)
    return _space(mesh.points, blocks), blocks, groups


def from_pyvista(grid: Any, own: list[Element]):
    grid = grid.cast_to_unstructured_grid() if hasattr(grid, "cast_to_unstructured_grid") else grid
    blocks = _blocks([(int(number), nodes) for number, nodes in grid.cells_dict.items()], own)
    return _space(np.asarray(grid.points), blocks), blocks, {}


def from_skfem(mesh: Any):
    # By the class, of which curved meshes are others.
    names = {"MeshLine1": "bar2", "MeshTri1": "tri3", "MeshQuad1": "quad4", "MeshTet1": "tet4", "MeshHex1": "hex8"}
    kind = type(mesh).__name__
    if kind not in names:
        raise _error("mesh", "one of " + ", ".join(names), kind, "unsupported")
    nodes = np.asarray(mesh.t.T, dtype=np.int64)
    if kind == "MeshHex1":
        # Corners of the unit cube as scikit-fem numbers them, in VTK's order.
        nodes = nodes[:, [0, 3, 6, 2, 1, 5, 7, 4]]
    groups = {name: np.unique(mesh.facets[:, places]) for name, places in (mesh.boundaries or {}).items()}
    return np.ascontiguousarray(mesh.p.T), {names[kind]: nodes}, groups


def from_gmsh(read, scale: float, options: dict):
    import gmsh

    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "model.msh")
        gmsh.write(path)
        return read(path, scale=scale, **options)

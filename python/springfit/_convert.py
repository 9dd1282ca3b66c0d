"""Meshes of other packages as points, cells and groups. None of these packages is required."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core
from ._arguments import FOREIGN, along_axes, array, element_of, failure, matrix, places, shown, typed, warn
from ._core import Element, shipped_elements

if TYPE_CHECKING:
    from .mesh import Mesh
else:
    Mesh = Any

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


def _elements(own: list[Element]) -> dict[int, tuple[Element, list[int]]]:
    """By the number of VTK's cell, with the place in VTK's list of each node; own elements before the shipped ones."""
    known: dict[int, tuple[Element, list[int]]] = {}
    for element in own + [Element(name) for name in shipped_elements()]:
        if element.vtk is not None:
            number, order = element.vtk
            known.setdefault(number, (element, order))
    return known


def _dimension(number: int) -> int:
    return _DIMENSION.get(number, 3)


def _blocks(cells: list[tuple[int, Any]], own: list[Element]) -> list[tuple[Element, np.ndarray]]:
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


def _join(groups: dict[str, Any], key: str, places: np.ndarray) -> None:
    """Adds places to a group, which may have others already."""
    groups[key] = np.union1d(groups[key], places) if key in groups else np.unique(places)


def hint(name: object) -> str:
    """What a name of meshio means here, for errors."""
    return f'; did you mean "{FOREIGN[name]}"?' if isinstance(name, str) and name in FOREIGN else ""


def from_meshio(mesh: Any, own: list[Element]) -> tuple:
    cells: list[tuple[int, np.ndarray]] = []
    groups: dict[str, Any] = {}
    # By name, the cells of each block.
    listed: dict[str, dict[int, Any]] = {}
    names = {tuple(np.atleast_1d(v)[:2]): name for name, v in (getattr(mesh, "field_data", None) or {}).items()}
    physical = (mesh.cell_data or {}).get("gmsh:physical", [None] * len(mesh.cells))
    for number_of_block, (block, marks) in enumerate(zip(mesh.cells, physical)):
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
                chosen = np.flatnonzero(np.asarray(marks) == mark)
                _join(groups, name, nodes[chosen])
                _join(listed.setdefault(name, {}), number_of_block, chosen)
    for name, lists in (getattr(mesh, "cell_sets", None) or {}).items():
        # meshio keeps what else it has read of a Gmsh file under such names.
        if not name.startswith("gmsh:"):
            for number_of_block, ((_, nodes), chosen) in enumerate(zip(cells, lists)):
                if chosen is not None:
                    chosen = places(f"cell_sets.{name}", chosen, len(nodes), "cells of the block")
                    _join(groups, name, nodes[chosen])
                    _join(listed.setdefault(name, {}), number_of_block, chosen)
    for name, chosen in (mesh.point_sets or {}).items():
        _join(groups, name, places(f"point_sets.{name}", chosen, len(mesh.points)))
    blocks = _blocks(cells, own)
    return _space(mesh.points, blocks), blocks, groups, _cells_of_groups(cells, blocks, listed)


def _cells_of_groups(cells: list, blocks: list, listed: dict[str, dict[int, Any]]) -> dict[str, np.ndarray]:
    """By name, the cells among those of the body, counted as the mesh counts them: those of one element together."""
    most = max((_dimension(number) for number, _ in cells), default=0)
    of_body = [place for place, (number, _) in enumerate(cells) if _dimension(number) == most]
    order = list(dict.fromkeys(element.name for element, _ in blocks))
    first, total = {}, 0
    for name in order:
        for place, (element, nodes) in zip(of_body, blocks):
            if element.name == name:
                first[place] = total
                total += len(nodes)
    found = {name: [first[place] + chosen for place, chosen in own.items() if place in first] for name, own in listed.items()}
    return {name: np.concatenate(lists) for name, lists in found.items() if sum(map(len, lists))}


def from_pyvista(grid: Any, own: list[Element]) -> tuple:
    grid = grid.cast_to_unstructured_grid() if hasattr(grid, "cast_to_unstructured_grid") else grid
    try:
        cells = grid.cells_dict
    except ValueError as error:
        # Such as polyhedra.
        raise failure("cells", "cells that are lists of nodes", str(error), "unsupported") from error
    blocks = _blocks([(int(number), nodes) for number, nodes in cells.items()], own)
    return _space(grid.points, blocks), blocks, {}, {}


def from_skfem(mesh: Any) -> tuple:
    # By the class, of which curved meshes are others.
    names = {"MeshLine1": "bar2", "MeshTri1": "tri3", "MeshQuad1": "quad4", "MeshTet1": "tet4", "MeshHex1": "hex8"}
    kind = type(mesh).__name__
    if kind not in names:
        raise failure("mesh", "one of " + ", ".join(names), kind, "unsupported")
    nodes = mesh.t.T
    groups: dict[str, Any] = {}
    cell_groups: dict[str, Any] = {}
    for key, owners in (("boundaries", mesh.facets.T), ("subdomains", nodes)):
        for name, chosen in (getattr(mesh, key) or {}).items():
            chosen = places(f"{key}.{name}", chosen, len(owners), key)
            _join(groups, name, owners[chosen])
            if key == "subdomains" and chosen.size:
                cell_groups[name] = chosen
    if kind == "MeshHex1":
        # Corners of the unit cube as scikit-fem numbers them, in VTK's order.
        nodes = nodes[:, [0, 3, 6, 2, 1, 5, 7, 4]]
    return mesh.p.T, {names[kind]: nodes}, groups, cell_groups


def from_gmsh(read: Any, scale: "float | str", options: dict) -> Any:
    import gmsh

    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "model.msh")
        gmsh.write(path)
        return read(path, scale=scale, **options)


def _vtk_blocks(mesh: Mesh) -> list[tuple[int, np.ndarray]]:
    """The numbers of VTK's cells and their nodes in VTK's order, block after block."""
    found = []
    for element, nodes in zip(mesh._core.elements, mesh.cells.values()):
        if element.vtk is None:
            raise failure("cells", "elements that name their VTK type in [formats]", element.name, "unsupported")
        number, order = element.vtk
        own = np.empty_like(nodes)
        own[:, order] = nodes
        found.append((number, own))
    return found


def _in_space(vectors: np.ndarray) -> np.ndarray:
    found = np.zeros((len(vectors), 3))
    found[:, : vectors.shape[1]] = vectors
    return found


def to_meshio(mesh: Mesh) -> Any:
    meshio = _meshio()
    names = {number: name for name, number in _MESHIO.items()}
    blocks = _vtk_blocks(mesh)
    for number, _ in blocks:
        if number not in names:
            raise failure("cells", "cells of " + ", ".join(_MESHIO), f"VTK's cell type {number}", "unsupported")
    counts = np.cumsum([0, *(len(nodes) for _, nodes in blocks)])
    sets = {name: [own[(own >= a) & (own < b)] - a for a, b in zip(counts, counts[1:])] for name, own in mesh.cell_groups.items()}
    cells = [(names[number], nodes) for number, nodes in blocks]
    try:
        return meshio.Mesh(np.array(mesh.points), cells, point_sets=mesh.groups, cell_sets=sets)
    except KeyError as unknown:
        # meshio has names for some cells and does not take them in a mesh.
        raise failure("cells", "cells that meshio takes", str(unknown.args[0]), "unsupported") from unknown


def _meshio() -> Any:
    try:
        import meshio
    except ImportError as error:
        raise failure("meshio", "the package meshio: pip install meshio", "none", "unsupported") from error
    return meshio


#: Abaqus's names of VTK's cells: of solids, of plane cells, and of surfaces and curves in space.
_ABAQUS = {
    **{(10, 3): "C3D4", (24, 3): "C3D10", (12, 3): "C3D8", (25, 3): "C3D20", (13, 3): "C3D6", (26, 3): "C3D15"},
    **{(5, 2): "CPS3", (22, 2): "CPS6", (9, 2): "CPS4", (23, 2): "CPS8", (3, 2): "T2D2"},
    **{(5, 3): "S3", (22, 3): "STRI65", (9, 3): "S4", (23, 3): "S8R", (3, 3): "T3D2"},
}
#: What names of sets may not have.
_NO_NAME = (",", "\n", '"', "*")


def _save_deck(mesh: Mesh, path: str) -> None:
    """A deck of Abaqus with groups as sets of nodes and of elements. meshio's names plane cells as rigid ones."""
    blocks = _vtk_blocks(mesh)
    for element, (number, _) in zip(mesh._core.elements, blocks):
        if (number, mesh.dimension) not in _ABAQUS:
            raise failure("cells", "cells of " + ", ".join(dict.fromkeys(_ABAQUS.values())), element.name, "unsupported")
    for name in (*mesh.groups, *mesh.cell_groups):
        if any(sign in name for sign in _NO_NAME):
            raise failure("groups", "names without commas, quotes and stars, for Abaqus", f"{name!r}")
    for groups in (mesh.groups, mesh.cell_groups):
        known: "dict[str, str]" = {}
        for name in groups:
            # Names of Abaqus have no case: both sets would be read as one.
            if known.setdefault(name.lower(), name) != name:
                raise failure("groups", "names that differ by more than capital letters, for Abaqus", f"{known[name.lower()]!r} and {name!r}")
    lines, first = ["*HEADING", "*NODE"], 1
    lines += [f"{i}, {', '.join(map(repr, x))}" for i, x in enumerate(_in_space(mesh.points).tolist(), 1)]
    for number, nodes in blocks:
        lines.append(f"*ELEMENT, TYPE={_ABAQUS[number, mesh.dimension]}")
        for i, own in enumerate((nodes + 1).tolist(), first):
            row = [i, *own]
            # A line has 16 numbers at most, and one that goes on ends with a comma.
            parts = [", ".join(map(str, row[k : k + 16])) for k in range(0, len(row), 16)]
            lines.append(",\n".join(parts))
        first += len(nodes)
    for kind, groups in (("NSET", mesh.groups), ("ELSET", mesh.cell_groups)):
        for name, places in groups.items():
            lines.append(f'*{kind}, {kind}="{name}"')
            numbers = (places + 1).tolist()
            lines += [", ".join(map(str, numbers[k : k + 16])) for k in range(0, len(numbers), 16)]
    with open(path, "w") as file:
        file.write("\n".join(lines) + "\n")


def save(mesh: Mesh, path: str) -> None:
    ending = os.path.splitext(path)[1].lower()
    if ending == ".inp":
        return _save_deck(mesh, path)
    meshio = _meshio()
    known = sorted(meshio.extension_to_filetypes)
    if ending not in known:
        raise failure("path", f"an ending of meshio's formats: {', '.join(known)}", f'"{path}"', "unsupported")
    found = to_meshio(mesh)
    if mesh.groups:
        warn(f"files of {ending} have no groups: .inp keeps them")
    found.point_sets, found.cell_sets = {}, {}
    if mesh.dimension < 3:
        # Most formats have three coordinates.
        found.points = _in_space(found.points)
    expected = "a format that meshio writes, with these cells"
    try:
        meshio.write(path, found)
    except (meshio.WriteError, KeyError, TypeError, ImportError) as error:
        raise failure("path", expected, str(error) or type(error).__name__, "unsupported") from error
    # Some formats leave cells out that they do not know, or write them without their middle nodes.
    try:
        again = meshio.read(path).cells
    except Exception:
        # meshio writes more formats than it reads.
        return
    counts = [sorted((block.type, len(block.data)) for block in blocks) for blocks in (found.cells, again)]
    if _sums(counts[0]) != _sums(counts[1]):
        os.remove(path)
        words = ", ".join(f"{count} of {name}" for name, count in _sums(counts[1]).items()) or "no cells"
        raise failure("path", expected, f"one that keeps {words}", "unsupported")


def _sums(counts: "list[tuple[str, int]]") -> "dict[str, int]":
    """The number of cells of each type."""
    found: "dict[str, int]" = {}
    for name, count in counts:
        found[name] = found.get(name, 0) + count
    return found


def to_pyvista(mesh: Mesh, u: Any) -> Any:
    import pyvista

    blocks = _vtk_blocks(mesh)
    grid = pyvista.UnstructuredGrid({number: nodes for number, nodes in blocks}, _in_space(mesh.points))
    count = sum(len(nodes) for _, nodes in blocks)
    for name, own in mesh.cell_groups.items():
        flags = np.zeros(count, dtype=bool)
        flags[own] = True
        grid.cell_data[name] = flags
    if u is not None:
        given = matrix("u", u, np.float64)
        if given.shape != mesh.points.shape:
            raise failure("u", f"an array of shape {mesh.points.shape}", f"one of shape {given.shape}")
        grid.point_data["u"] = _in_space(given)
    return grid


def normals(mesh: Mesh) -> np.ndarray:
    points, found = mesh.points, []
    for element, (number, nodes) in zip(mesh._core.elements, _vtk_blocks(mesh)):
        if element.dimension != mesh.dimension - 1:
            expected = "cells of one dimension less than the space, as Mesh.boundary has"
            raise failure("normals", expected, f"{element.name} in {mesh.dimension} dimensions")
        corners = points[nodes]
        if mesh.dimension == 2:
            along = corners[:, 1] - corners[:, 0]
            own = np.column_stack([along[:, 1], -along[:, 0]])
        elif number in (5, 22, 34):
            own = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        else:
            # Of a quadrangle that is bent: across both diagonals.
            own = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
        found.append(own / np.linalg.norm(own, axis=1, keepdims=True))
    return np.concatenate(found)


def surface_of(surface: Any) -> tuple[str | None, tuple | None]:
    """A surface as a path, or as its points and lists of polygons."""
    if isinstance(surface, (str, os.PathLike)):
        return os.fspath(surface), None
    expected = "a file, a surface Mesh, a trimesh.Trimesh, a pyvista.PolyData, or points and triangles"
    if hasattr(surface, "_core") and hasattr(surface, "cells"):
        points, polygons = surface.points, list(surface.cells.values())
    elif hasattr(surface, "vertices") and hasattr(surface, "faces"):
        points, polygons = surface.vertices, [surface.faces]
    elif hasattr(surface, "triangulate") and hasattr(surface, "points"):
        points, polygons = surface.points, [surface.triangulate().faces.reshape(-1, 4)[:, 1:]]
    elif isinstance(surface, (tuple, list)) and len(surface) == 2:
        points, polygons = surface[0], [surface[1]]
    else:
        raise failure("surface", expected, shown(surface))
    return None, (matrix("surface", points, np.float64), [matrix("surface", cells, np.int64) for cells in polygons])


def voxels(values: Any, spacing: Any, labels: Any, element: Any, origin: Any) -> _core.Mesh:
    found = array("array", values)
    if found.dtype.kind not in "biu":
        raise failure("array", "integers or flags, a label of each voxel", f"values of type {found.dtype}")
    if found.ndim not in (2, 3):
        raise failure("array", "an array of two or three axes", f"one of shape {found.shape}")
    found = np.ascontiguousarray(found.astype(np.int64))

    def along(key: str, given: Any) -> list[float]:
        own = array(key, given)
        full = np.full(found.ndim, own) if own.ndim == 0 else own
        if full.shape != (found.ndim,):
            raise failure(key, f"one number, or {found.ndim}, one for each axis", f"values of shape {full.shape}")
        if not np.isfinite(typed(key, full, np.float64)).all():
            raise failure(key, "finite numbers", full.tolist())
        return along_axes(key, full, np.float64)

    lengths, corner = along("spacing", spacing), along("origin", origin)
    if min(lengths) <= 0:
        raise failure("spacing", "lengths above zero, m", min(lengths))
    names = None
    if labels is not None:
        if not isinstance(labels, Mapping) or not labels:
            raise failure("labels", 'a dictionary of labels by name, such as {"bone": 1}', shown(labels))
        names = [(name, typed(f"labels.{name}", np.atleast_1d(array(f"labels.{name}", own)), np.int64).tolist()) for name, own in labels.items()]
        kept = np.unique(np.concatenate([own for _, own in names]))
        found = np.where(np.isin(found, kept), found, 0)
        absent = [(name, label) for name, own in names for label in own if label == 0 or not (found == label).any()]
        if absent:
            name, label = absent[0]
            raise failure(f"labels.{name}", "a label above or below zero that some voxel has", label)
    if not found.any():
        raise failure("array", "a voxel whose label is not zero", "zeros alone")
    usual = "hex8" if found.ndim == 3 else "quad4"
    pad = [1.0] * (3 - found.ndim)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "labels.npy")
        np.save(path, found)
        return _core.voxel_mesh(path, element_of(usual if element is None else element), lengths + pad, corner + [0.0 for _ in pad], names)

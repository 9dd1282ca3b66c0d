"""Meshes: from arrays, from files, from the objects of other packages."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np

from . import _core, _convert
from ._core import Element, SpringfitError


def element_of(name: "str | os.PathLike | Element") -> Element:
    """An element itself, the shipped one of this name, or the one of the file at this path."""
    return name if isinstance(name, Element) else Element(os.fspath(name))


def failure(key: str, expected: str, found: object) -> SpringfitError:
    """The error of an argument, as the library would raise it."""
    error = SpringfitError(f"{key}: expected {expected}, found {found}")
    error.kind, error.file, error.line, error.key = "invalid", None, None, key
    return error


def matrix(key: str, values: Any, dtype: type) -> np.ndarray:
    """A two-dimensional array of this type, whose values are kept as they are."""
    array = np.asarray(values)
    if array.ndim != 2:
        raise failure(key, "an array of two dimensions", f"one of shape {array.shape}")
    if np.issubdtype(dtype, np.integer):
        if not np.issubdtype(array.dtype, np.integer):
            raise failure(key, "integers", f"values of type {array.dtype}")
    elif not (np.issubdtype(array.dtype, np.floating) or np.issubdtype(array.dtype, np.integer)):
        raise failure(key, "real numbers", f"values of type {array.dtype}")
    return np.ascontiguousarray(array, dtype=dtype)


class Mesh:
    """Points, cells of known elements, and named groups of points.

    Args:
        points: Coordinates in metres, shape (points, dimension), the dimension being 1, 2 or 3.
        cells: By element, the nodes of its cells: places in ``points`` from 0, shape (cells, nodes of the element), in the order of
            the element's nodes (``Element(name).positions``). A key is a shipped element's name, the path of an element file, or an
            ``Element``. A list of pairs is taken as well.
        groups: By name, places in ``points``. Supports and loads of scenes name groups. A group has the sides on the boundary and the
            cells all of whose nodes it has.
        below: What becomes of cells whose quality is below ``least``: "warn" (the default), "refuse" or "skip". Cells that are flat or
            tangled, repeat another or are folded over their neighbours are left out with "skip" and an error otherwise.
        least: The least quality, from 0 for flat to 1 for right angles.

    Raises:
        SpringfitError: An array has a wrong shape, type or value, or a cell is no cell.
    """

    def __init__(
        self,
        points: Any,
        cells: "Mapping[str | Element, Any] | Sequence[tuple[str | Element, Any]]",
        groups: "Mapping[str, Any] | None" = None,
        *,
        below: Literal["warn", "refuse", "skip"] | None = None,
        least: float | None = None,
    ) -> None:
        points = matrix("points", points, np.float64)
        pairs = list(cells.items() if isinstance(cells, Mapping) else cells)
        blocks = []
        for name, nodes in pairs:
            element = element_of(name)
            blocks.append((element, matrix(f"cells of {element.name}", nodes, np.int64)))
        named = {}
        for name, places in (groups or {}).items():
            places = np.asarray(places)
            if places.dtype == bool and places.shape == (len(points),):
                places = np.flatnonzero(places)
            if places.size == 0:
                places = places.astype(np.int64)
            if places.ndim != 1 or not np.issubdtype(places.dtype, np.integer):
                expected = "a list of places of points, or a flag for each point"
                raise failure(f"groups.{name}", expected, f"values of type {places.dtype}, shape {places.shape}")
            named[name] = np.ascontiguousarray(places, dtype=np.int64)
        self._core = _core.Mesh.of_arrays(points, blocks, named, below, least)

    @classmethod
    def _of(cls, core: "_core.Mesh") -> "Mesh":
        mesh = cls.__new__(cls)
        mesh._core = core
        return mesh

    @classmethod
    def read(
        cls,
        path: "str | os.PathLike",
        *,
        scale: float = 1.0,
        elements: "Sequence[str | Element]" = (),
        below: Literal["warn", "refuse", "skip"] | None = None,
        least: float | None = None,
    ) -> "Mesh":
        """The mesh of a ``.msh``, ``.vtu`` or ``.vtk`` file.

        Args:
            path: The file.
            scale: The length of one of its units in metres.
            elements: Element files, or elements, that are asked before the shipped ones.
        """
        own = [element_of(element) for element in elements]
        return cls._of(_core.Mesh.read(os.fspath(path), float(scale), own, below, least))

    @classmethod
    def box(
        cls, element: "str | Element", size: Sequence[float], cells: Sequence[int], origin: "Sequence[float] | None" = None
    ) -> "Mesh":
        """A rectangle or a brick of equal cells, ``size`` metres long, with groups ``xmin``, ``xmax``, ``ymin``, … and ``body``."""
        origin = [0.0] * len(size) if origin is None else list(origin)
        return cls._of(_core.Mesh.of_box(element_of(element), list(size), list(cells), origin))

    @classmethod
    def from_meshio(cls, mesh: Any, *, elements: "Sequence[str | Element]" = (), **options: Any) -> "Mesh":
        """Of a ``meshio.Mesh``: its cells of the highest dimension, and its point sets and physical groups."""
        return cls(*_convert.from_meshio(mesh, [element_of(e) for e in elements]), **options)

    @classmethod
    def from_pyvista(cls, grid: Any, *, elements: "Sequence[str | Element]" = (), **options: Any) -> "Mesh":
        """Of a ``pyvista.UnstructuredGrid`` or ``PolyData``: its cells of the highest dimension."""
        return cls(*_convert.from_pyvista(grid, [element_of(e) for e in elements]), **options)

    @classmethod
    def from_skfem(cls, mesh: Any, **options: Any) -> "Mesh":
        """Of a scikit-fem mesh of linear cells; its named boundaries become groups."""
        return cls(*_convert.from_skfem(mesh), **options)

    @classmethod
    def from_trimesh(cls, mesh: Any, **options: Any) -> "Mesh":
        """Of a ``trimesh.Trimesh``: a surface of triangles, which requires a thickness in its material."""
        return cls(np.asarray(mesh.vertices), {"tri3": np.asarray(mesh.faces)}, **options)

    @classmethod
    def from_gmsh(cls, *, scale: float = 1.0, **options: Any) -> "Mesh":
        """Of the current model of the ``gmsh`` package."""
        return _convert.from_gmsh(cls.read, scale, options)

    @property
    def dimension(self) -> int:
        """Of the space: 1, 2 or 3."""
        return self._core.dimension

    @property
    def points(self) -> np.ndarray:
        """Coordinates, m, shape (points, dimension). Points that belong to no cell have been left out, see :attr:`numbers`."""
        return self._core.points

    @property
    def cells(self) -> "list[tuple[str, np.ndarray]]":
        """Element names and the nodes of their cells. Cells that were numbered the other way round have been turned."""
        return self._core.blocks

    @property
    def groups(self) -> "dict[str, np.ndarray]":
        """The points of each group, ascending."""
        return self._core.groups

    @property
    def numbers(self) -> "np.ndarray | None":
        """The number of each point where it comes from: its place in the array or the VTK file, or its Gmsh tag."""
        return self._core.numbers

    @property
    def quality(self) -> dict:
        """What was found about the cells: the worst quality, and how many are poor, left out, turned, hanging, in how many pieces."""
        return self._core.quality

    def __repr__(self) -> str:
        cells = ", ".join(f"{len(nodes)} {name}" for name, nodes in self.cells)
        return f"<springfit.Mesh: {len(self.points)} points in {self.dimension} dimensions, {cells}>"

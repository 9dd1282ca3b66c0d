"""Meshes: from arrays, from files, from the objects of other packages."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal, Union

import numpy as np

from . import _convert, _core
from ._arguments import Element, ElementLike, along_axes, element_of, elements_of, failure, matrix, number, places, shown, warn, word

Below = Literal["warn", "refuse", "skip"]
# The keys are those of ElementLike; types of dictionaries hold for one type of keys alone.
Cells = Union[Mapping[Any, Any], Iterable["tuple[ElementLike, Any]"]]

#: The least quality without a warning, as the library has it.
LEAST = 1e-4


class Mesh:
    """Points, cells of known elements, and named groups of points.

    Args:
        points: Coordinates in metres, shape (points, dimension), the dimension being 1, 2 or 3.
        cells: By element, the nodes of its cells: places in ``points`` from 0, shape (cells, nodes of the element), in the order of
            the element's nodes (``Element(name).positions``). A key is a shipped element's name, the path of an element file, or an
            ``Element``. A list of pairs is taken as well, such as :attr:`cells` of another mesh; cells of one element are put together.
        groups: By name, places in ``points``, or a flag for each point. Supports and loads of scenes name groups. A group has the sides
            on the boundary and the cells all of whose nodes it has.
        elements: Element files, or elements, that names of ``cells`` mean before the shipped ones.
        below: What becomes of cells whose quality is below ``least``: "warn" (the default) gives a warning with the worst of them, "refuse"
            an error, and "skip" leaves them out. Cells that are flat or tangled, repeat another or are folded over their neighbours are
            left out with "skip" and an error otherwise.
        least: The least quality, from 0 for flat to 1 for right angles; 1e-4 if None.

    A warning tells when points belong to no cell that is left, as the others are numbered anew without them.

    Raises:
        SpringfitError: An array has a wrong shape, type or value, or a cell is no cell.
    """

    def __init__(
        self,
        points: Any,
        cells: Cells,
        groups: "Mapping[str, Any] | None" = None,
        *,
        elements: "Sequence[ElementLike]" = (),
        below: "Below | None" = None,
        least: float | None = None,
    ) -> None:
        points = matrix("points", points, np.float64)
        blocks = _blocks(cells, elements_of(elements))
        if not isinstance(groups, (Mapping, type(None))):
            raise failure("groups", "a dictionary of places of points by name", shown(groups))
        named = {name: places(f"groups.{name}", own, len(points)) for name, own in (groups or {}).items()}
        self._core = _core.Mesh.of_arrays(points, blocks, named, *_gate(below, least))
        unused = len(points) - len(self._core.points)
        if unused:
            left = f"{unused} of {len(points)} points belong to no cell that is left"
            warn(f"{left}: the others are numbered anew without them, and Mesh.numbers has their places before")
        self._warn_of_cells(least)

    def _warn_of_cells(self, least: "float | None") -> None:
        quality = self._core.quality
        if quality["poor"]:
            least = LEAST if least is None else least
            warn(
                f"{quality['poor']} cells have a quality below {least:g}, the worst {quality['worst']:.1e} ({quality['worst_cell']}): "
                "their spring constants lose accuracy in proportion"
            )

    @classmethod
    def _of(cls, core: "_core.Mesh", least: "float | None" = None) -> "Mesh":
        mesh = cls.__new__(cls)
        mesh._core = core
        mesh._warn_of_cells(least)
        return mesh

    @classmethod
    def read(
        cls,
        path: "str | os.PathLike[str]",
        *,
        scale: float = 1.0,
        elements: "Sequence[ElementLike]" = (),
        below: "Below | None" = None,
        least: float | None = None,
        space: "int | None" = None,
    ) -> "Mesh":
        """The mesh of a file in one of the formats of the library, such as ``.msh``, ``.vtu``, ``.inp``, ``.bdf`` or ``.stl``.

        Args:
            path: The file.
            scale: The length of one of its units in metres.
            elements: Element files, or elements, that are asked before the shipped ones.
            below, least: As for arrays.
            space: The dimension of the space, 2 or 3. By default surfaces of ``.obj``, ``.stl``, ``.ply``, ``.off`` and ``.vtp`` are in space,
                and others in the plane where all their points have one z.

        A warning says what the file holds besides the body, such as cells of fewer dimensions, supports and loads.
        """
        if space not in (None, 2, 3):
            raise failure("space", "2 or 3", space)
        core = _core.Mesh.read(os.fspath(path), _scale(scale), elements_of(elements), *_gate(below, least), space)
        for note in core.annotations:
            warn(note)
        return cls._of(core, least)

    @classmethod
    def box(
        cls,
        element: ElementLike,
        size: "Sequence[float] | np.ndarray",
        cells: "Sequence[int] | np.ndarray",
        origin: "Sequence[float] | np.ndarray | None" = None,
        *,
        below: "Below | None" = None,
        least: float | None = None,
    ) -> "Mesh":
        """A rectangle or a brick of equal cells, ``size`` metres long, with groups ``xmin``, ``xmax``, ``ymin``, … and ``body``.

        The quality of its cells is checked, as that of arrays, if ``below`` or ``least`` is given."""
        lengths, counts = along_axes("size", size, np.float64), along_axes("cells", cells, np.int64)
        if min(counts, default=1) < 1:
            raise failure("cells", "numbers of cells above zero", min(counts))
        start = [0.0] * len(lengths) if origin is None else along_axes("origin", origin, np.float64)
        element = element_of(element)
        box = _core.Mesh.of_box(element, lengths, counts, start)
        if below is None and least is None:
            return cls._of(box)
        return cls(box.points, [(element, nodes) for _, nodes in box.blocks], box.groups, below=below, least=least)

    @classmethod
    def from_meshio(cls, mesh: Any, *, scale: float = 1.0, elements: "Sequence[ElementLike]" = (), **options: Any) -> "Mesh":
        """Of a ``meshio.Mesh``: its cells of the highest dimension, and its point sets, cell sets and physical groups. Sets of one name are
        one group.

        Args:
            scale: The length of one of its units in metres.
            elements: Element files, or elements, that are asked before the shipped ones.
            **options: ``below`` and ``least``, as for arrays.
        """
        return cls._converted(_convert.from_meshio(mesh, elements_of(elements)), scale, options)

    @classmethod
    def from_pyvista(cls, grid: Any, *, scale: float = 1.0, elements: "Sequence[ElementLike]" = (), **options: Any) -> "Mesh":
        """Of a ``pyvista`` grid, image or ``PolyData``: its cells of the highest dimension. Arguments are those of :meth:`from_meshio`.

        Each cell of an image is a cell of the mesh, whatever its values; :meth:`read` of a ``.vti`` file takes labels."""
        return cls._converted(_convert.from_pyvista(grid, elements_of(elements)), scale, options)

    @classmethod
    def from_skfem(cls, mesh: Any, *, scale: float = 1.0, **options: Any) -> "Mesh":
        """Of a scikit-fem mesh of linear cells; its named boundaries and subdomains become groups. Those of one name are one group.
        Arguments are those of :meth:`from_meshio`."""
        return cls._converted(_convert.from_skfem(mesh), scale, options)

    @classmethod
    def from_trimesh(cls, mesh: Any, *, scale: float = 1.0, **options: Any) -> "Mesh":
        """Of a ``trimesh.Trimesh``: a surface of triangles, which requires a thickness in its material. Arguments are those of
        :meth:`from_meshio`."""
        return cls._converted((mesh.vertices, {"tri3": mesh.faces}, None), scale, options)

    @classmethod
    def _converted(cls, found: "tuple[Any, Cells, Any]", scale: float, options: dict) -> "Mesh":
        points, cells, groups = found
        return cls(_scale(scale) * matrix("points", points, np.float64), cells, **{"groups": groups, **options})

    @classmethod
    def from_gmsh(cls, *, scale: float = 1.0, **options: Any) -> "Mesh":
        """Of the current model of the ``gmsh`` package. Arguments are those of :meth:`read`."""
        return _convert.from_gmsh(cls.read, scale, options)

    @property
    def dimension(self) -> int:
        """Of the space: 1, 2 or 3."""
        return self._core.dimension

    @property
    def points(self) -> np.ndarray:
        """Coordinates, m, shape (points, dimension). Points that belong to no cell have been left out, see :attr:`numbers`. Places of points
        in ``fix``, and rows of forces, displacements and networks, are those of this array."""
        return self._core.points

    @property
    def cells(self) -> "list[tuple[str, np.ndarray]]":
        """Element names and the nodes of their cells, one pair for each element. Cells that were numbered the other way round have been
        turned."""
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


def _gate(below: Any, least: Any) -> "tuple[str | None, float | None]":
    least = None if least is None else number("least", least, "a quality from 0 to 1")
    return word("below", below, '"warn", "refuse" or "skip"'), least


def _scale(scale: Any) -> float:
    expected = "metres per mesh unit, a number above zero"
    found = number("scale", scale, expected)
    if not 0.0 < found < float("inf"):
        raise failure("scale", expected, found)
    return found


def _blocks(cells: Any, own: "list[Element]") -> "list[tuple[Element, np.ndarray]]":
    """Elements and the nodes of their cells. Those of one element are put together, so that a name tells them."""
    expected = "a dictionary of nodes by element, or a list of pairs of both"
    if not isinstance(cells, Iterable):
        raise failure("cells", expected, shown(cells))
    pairs = list(cells.items() if isinstance(cells, Mapping) else cells)
    if not all(isinstance(pair, (tuple, list)) and len(pair) == 2 for pair in pairs):
        raise failure("cells", expected, shown(cells))
    named = {element.name: element for element in reversed(own)}
    found: "dict[str, tuple[Any, Element, list[np.ndarray]]]" = {}
    for given, nodes in pairs:
        element = named.get(given, None) if isinstance(given, str) else None
        element = element_of(given) if element is None else element
        key = f"cells of {element.name}"
        first, _, lists = found.setdefault(element.name, (given, element, []))
        if first is not given and first != given:
            raise failure(key, "one element of a name", "another of the same name")
        lists.append(matrix(key, nodes, np.int64))
        if lists[-1].shape[1] != element.nodes:
            raise failure(key, f"an array of shape (cells, {element.nodes})", f"one of shape {lists[-1].shape}")
    # Most have one list, which needs no copy.
    return [(element, np.concatenate(lists) if len(lists) > 1 else lists[0]) for _, element, lists in found.values()]

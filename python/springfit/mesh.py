"""Meshes: from arrays, from files, from the objects of other packages."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, Union, overload

import numpy as np

from . import _convert, _core
from ._arguments import Element, ElementLike, along_axes, count, element_of, elements_of, failure, matrix, measure, number, places, shown, warn, word
from ._lazy import Package

Below = Literal["warn", "refuse", "skip"]
# The keys are those of ElementLike; types of dictionaries hold for one type of keys alone.
CellsLike = Union[Mapping[Any, Any], Iterable["tuple[ElementLike, Any]"]]

if TYPE_CHECKING:
    import meshio
    import pyvista
else:
    meshio, pyvista = Package("meshio"), Package("pyvista")

#: The least quality without a warning, as the library has it.
LEAST = 1e-4
#: How often edges may be halved.
MOST = 6


class Cells(Mapping[str, np.ndarray]):
    """The nodes of cells by the name of their element, in the order of the blocks of a mesh; read-only arrays.

    A place gives a pair of both: ``cells[0]`` is ``("tet4", nodes)``.

    Examples:
        >>> import springfit as sf
        >>> cells = sf.Mesh.box("tri3", size=[1, 1], cells=[1, 1]).cells
        >>> list(cells), cells["tri3"].shape, cells[0][0]
        (['tri3'], (2, 3), 'tri3')
    """

    def __init__(self, blocks: Iterable[tuple[str, np.ndarray]]) -> None:
        self._blocks = {name: _fixed(nodes) for name, nodes in blocks}

    @overload
    def __getitem__(self, key: str) -> np.ndarray: ...
    @overload
    def __getitem__(self, key: int) -> tuple[str, np.ndarray]: ...
    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, (int, np.integer)):
            return list(self._blocks.items())[key]
        if key not in self._blocks:
            raise KeyError(f"expected one of {', '.join(self._blocks)}, found {key!r}{_convert.hint(key)}")
        return self._blocks[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._blocks)

    def __len__(self) -> int:
        return len(self._blocks)

    def __repr__(self) -> str:
        return f"<springfit cells: {', '.join(f'{len(nodes)} {name}' for name, nodes in self.items())}>"


class Mesh:
    """Points, cells of known elements, and named groups of points and cells.

    Args:
        points: Coordinates in metres, shape (points, dimension), the dimension being 1, 2 or 3.
        cells: By element, the nodes of its cells: places in ``points`` from 0, shape (cells, nodes of the element), in the order of
            the element's nodes (``Element(name).positions``). A key is a shipped element's name, the path of an element file, or an
            ``Element``. A list of pairs is taken as well, such as :attr:`cells` of another mesh; cells of one element are put together.
        groups: By name, places in ``points``, or a flag for each point. Supports and loads of scenes name groups. A group has the sides
            on the boundary and the cells all of whose nodes it has.
        cell_groups: By name, places of cells, counted block after block, or a flag for each cell; regions of materials name them. A name that
            is in ``groups`` as well has these cells and those points.
        elements: Element files, or elements, that names of ``cells`` mean before the shipped ones.
        below: What becomes of cells whose quality is below ``least``: "warn" (the default) gives a warning with the worst of them, "refuse"
            an error, and "skip" leaves them out. Cells that are flat or tangled, repeat another or, where some cells are numbered in
            reverse, are folded over their neighbours are left out with "skip" and an error otherwise. Cells that lie on each other and
            are numbered alike are not looked for.
        least: The least quality, from 0 for flat to 1 for right angles; 1e-4 if None.

    A warning tells when points belong to no cell that is left, as the others are numbered anew without them.

    Raises:
        SpringfitError: An array has a wrong shape, type or value, or a cell is no cell.

    Examples:
        >>> import numpy as np, springfit as sf
        >>> points = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
        >>> mesh = sf.Mesh(points, {"tri3": [[0, 1, 2], [0, 2, 3]]}, {"left": points[:, 0] == 0}, cell_groups={"lower": [0]})
        >>> mesh
        <springfit.Mesh: 4 points in 2 dimensions, 2 tri3>
        >>> round(mesh.volume, 9), mesh.groups["left"].tolist(), mesh.cell_groups["lower"].tolist()
        (1.0, [0, 3], [0])
    """

    def __init__(
        self,
        points: Any,
        cells: CellsLike,
        groups: Mapping[str, Any] | None = None,
        *,
        cell_groups: Mapping[str, Any] | None = None,
        elements: Sequence[ElementLike] = (),
        below: Below | None = None,
        least: float | None = None,
    ) -> None:
        points = _points(points)
        blocks = _blocks(cells, elements_of(elements))
        for key, given in (("groups", groups), ("cell_groups", cell_groups)):
            if not isinstance(given, (Mapping, type(None))):
                raise failure(key, f"a dictionary of places of {'points' if key == 'groups' else 'cells'} by name", shown(given))
        named = {name: places(f"groups.{name}", own, len(points)) for name, own in (groups or {}).items()}
        count = sum(len(nodes) for _, nodes in blocks)
        of_cells = {name: places(f"cell_groups.{name}", own, count, "cells") for name, own in (cell_groups or {}).items()}
        self._parents: np.ndarray | None = None
        self._core = _core.Mesh.of_arrays(points, blocks, named, of_cells, *_gate(below, least))
        unused = len(points) - len(self._core.points)
        if unused:
            left = f"{unused} of {len(points)} points belong to no cell that is left"
            warn(f"{left}: the others are numbered anew without them, and Mesh.numbers has their places before")
        self._warn_of_cells(least)

    def _warn_of_cells(self, least: float | None) -> None:
        quality = self._core.quality
        if quality["poor"]:
            least = LEAST if least is None else least
            warn(
                f"{quality['poor']} cells have a quality below {least:g}, the worst {quality['worst']:.1e} ({quality['worst_cell']}): "
                "their spring constants lose accuracy in proportion"
            )
        if quality["folding"]:
            # Nodes in the order of another program look so: middle nodes lie on other edges.
            warn(
                f"{quality['folding']} curved cells fold between their quadrature points ({quality['folding_cells']}): if their nodes are in another "
                "order than that of the element, matrices and networks are wrong; Element.positions has the order"
            )

    @classmethod
    def _of(cls, core: _core.Mesh, least: float | None = None) -> Mesh:
        mesh = cls.__new__(cls)
        mesh._core = core
        mesh._parents = None
        mesh._warn_of_cells(least)
        return mesh

    @classmethod
    def read(
        cls,
        path: str | os.PathLike[str],
        *,
        scale: float | str = 1.0,
        elements: Sequence[ElementLike] = (),
        below: Below | None = None,
        least: float | None = None,
        space: int | None = None,
    ) -> Mesh:
        """The mesh of a file in one of the formats of the library, such as ``.msh``, ``.vtu``, ``.inp``, ``.bdf`` or ``.stl``.

        Args:
            path: The file.
            scale: The length of one of its units in metres, or a unit such as "mm".
            elements: Element files, or elements, that are asked before the shipped ones.
            below, least: As for arrays.
            space: The dimension of the space, 2 or 3. By default surfaces of ``.obj``, ``.stl``, ``.ply``, ``.off`` and ``.vtp`` are in space,
                and others in the plane where all their points have one z.

        A warning says what the file holds besides the body, such as cells of fewer dimensions, supports and loads.

        Raises:
            SpringfitError: The file or an argument is wrong. Of a file that is missing it is a ``FileNotFoundError`` as well.

        Examples:
            >>> import os, springfit as sf, tempfile
            >>> path = os.path.join(tempfile.mkdtemp(), "square.obj")
            >>> with open(path, "w") as file:
            ...     lines = file.write("v 0 0 0\\nv 1 0 0\\nv 1 1 0\\nv 0 1 0\\nf 1 2 3\\nf 1 3 4\\n")
            >>> sf.Mesh.read(path, scale=0.01, space=2)
            <springfit.Mesh: 4 points in 2 dimensions, 2 tri3>
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
        size: Sequence[float] | np.ndarray,
        cells: Sequence[int] | np.ndarray,
        origin: Sequence[float] | np.ndarray | None = None,
        *,
        below: Below | None = None,
        least: float | None = None,
    ) -> Mesh:
        """A rectangle or a brick of equal cells, ``size`` metres long, with groups ``xmin``, ``xmax``, ``ymin``, … and ``body``.

        The quality of its cells is checked, as that of arrays, if ``below`` or ``least`` is given.

        Examples:
            >>> import springfit as sf
            >>> sf.Mesh.box("hex8", size=[0.3, 0.1, 0.1], cells=[6, 2, 2])
            <springfit.Mesh: 63 points in 3 dimensions, 24 hex8>
        """
        lengths, counts = along_axes("size", size, np.float64), along_axes("cells", cells, np.int64)
        if min(counts, default=1) < 1:
            raise failure("cells", "numbers of cells above zero", min(counts))
        start = [0.0] * len(lengths) if origin is None else along_axes("origin", origin, np.float64)
        element = element_of(element)
        box = _core.Mesh.of_box(element, lengths, counts, start)
        if below is None and least is None:
            return cls._of(box)
        return cls(box.points, [(element, nodes) for _, nodes in box.blocks], box.groups, cell_groups=box.cell_groups, below=below, least=least)

    @classmethod
    def from_meshio(cls, mesh: Any, *, scale: float | str = 1.0, elements: Sequence[ElementLike] = (), **options: Any) -> Mesh:
        """Of a ``meshio.Mesh``: its cells of the highest dimension, and its point sets, cell sets and physical groups. Sets of one name are
        one group.

        Args:
            scale: The length of one of its units in metres, or a unit such as "mm".
            elements: Element files, or elements, that are asked before the shipped ones.
            **options: ``below`` and ``least``, as for arrays.

        Examples:
            >>> import springfit as sf
            >>> mesh = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[1, 1, 1])
            >>> sf.Mesh.from_meshio(mesh.to_meshio())
            <springfit.Mesh: 8 points in 3 dimensions, 6 tet4>
        """
        return cls._converted(_convert.from_meshio(mesh, elements_of(elements)), scale, options)

    @classmethod
    def from_pyvista(cls, grid: Any, *, scale: float | str = 1.0, elements: Sequence[ElementLike] = (), **options: Any) -> Mesh:
        """Of a ``pyvista`` grid, image or ``PolyData``: its cells of the highest dimension. Arguments are those of :meth:`from_meshio`.

        Each cell of an image is a cell of the mesh, whatever its values; :meth:`voxels` takes labels.

        Examples:
            >>> import pyvista, springfit as sf
            >>> sf.Mesh.from_pyvista(pyvista.ImageData(dimensions=(3, 3, 3)))
            <springfit.Mesh: 27 points in 3 dimensions, 8 hex8>
        """
        return cls._converted(_convert.from_pyvista(grid, elements_of(elements)), scale, options)

    @classmethod
    def from_skfem(cls, mesh: Any, *, scale: float | str = 1.0, **options: Any) -> Mesh:
        """Of a scikit-fem mesh of linear cells; its named boundaries and subdomains become groups. Those of one name are one group.
        Arguments are those of :meth:`from_meshio`.

        Examples:
            >>> import skfem, springfit as sf
            >>> sf.Mesh.from_skfem(skfem.MeshTri().refined(1))
            <springfit.Mesh: 9 points in 2 dimensions, 8 tri3>
        """
        return cls._converted(_convert.from_skfem(mesh), scale, options)

    @classmethod
    def from_trimesh(cls, mesh: Any, *, scale: float | str = 1.0, **options: Any) -> Mesh:
        """Of a ``trimesh.Trimesh``: a surface of triangles, which requires a thickness in its material. Arguments are those of
        :meth:`from_meshio`.

        Examples:
            >>> import springfit as sf, trimesh
            >>> sf.Mesh.from_trimesh(trimesh.creation.icosphere(subdivisions=1), scale=0.01)
            <springfit.Mesh: 42 points in 3 dimensions, 80 tri3>
        """
        return cls._converted((mesh.vertices, {"tri3": mesh.faces}, None, None), scale, options)

    @classmethod
    def _converted(cls, found: tuple[Any, CellsLike, Any, Any], scale: float | str, options: dict) -> Mesh:
        points, cells, groups, cell_groups = found
        return cls(_scale(scale) * _points(points), cells, **{"groups": groups, "cell_groups": cell_groups, **options})

    @classmethod
    def from_gmsh(cls, *, scale: float | str = 1.0, **options: Any) -> Mesh:
        """Of the current model of the ``gmsh`` package. Arguments are those of :meth:`read`."""
        return _convert.from_gmsh(cls.read, scale, options)

    @classmethod
    def fill(
        cls,
        surface: Any,
        *,
        cell: float | str | None = None,
        points: int | None = None,
        element: ElementLike = "hex8",
        boundary: Literal['stepped', 'smooth'] | None = None,
        layers: Literal['refuse', 'union'] | None = None,
        repair: bool = False,
        scale: float | str = 1.0,
    ) -> Mesh:
        """A closed surface filled with cells of a lattice, as ``[mesh.fill]`` of a scene.

        Args:
            surface: A file, such as ``.stl``; a surface :class:`Mesh`, a ``trimesh.Trimesh`` or a ``pyvista.PolyData``; or a pair of points
                (points, 3) and triangles (cells, 3).
            cell: The edge of the cubes of the lattice, in units of the surface, or a length such as "4 mm"; or
            points: about how many points the mesh has.
            element: Of hexahedra, which are the cubes, or of tetrahedra, twelve for each cube.
            boundary: "stepped" (the default) has whole cubes whose centres are inside; "smooth" tetrahedra that are cut off at the surface.
            layers: A surface that crosses itself is refused ("refuse"), or what any of its layers encloses is filled ("union").
            repair: Whether a damaged surface, such as a scan, is mended first.
            scale: The length of one unit of the surface in metres, or a unit such as "mm".

        Raises:
            SpringfitError: The surface is open or crosses itself, or an argument is wrong.

        Examples:
            >>> import springfit as sf, trimesh
            >>> ball = sf.Mesh.fill(trimesh.creation.icosphere(subdivisions=3), cell=0.2, element="tet4", boundary="smooth", scale=0.01)
            >>> round(ball.volume / (4.1888e-6), 1)
            1.0
        """
        path, arrays = _convert.surface_of(surface)
        size = _scale(scale)
        edge = None if cell is None else measure("cell", cell, "the edge of a cube, in units of the surface, or a length")
        if isinstance(cell, str) and edge is not None and not _is_number(cell):
            edge /= size
        about = None if points is None else count("points", points)
        options = (word("boundary", boundary, '"stepped" or "smooth"'), word("layers", layers, '"refuse" or "union"'), _flag("repair", repair))
        core = _core.filled_mesh(path, arrays, element_of(element), edge, about, options, size)
        for note in core.annotations:
            warn(note)
        return cls._of(core)

    @classmethod
    def voxels(
        cls,
        array: Any,
        spacing: Any = 1.0,
        labels: Mapping[str, Any] | None = None,
        *,
        element: ElementLike | None = None,
        origin: Any = 0.0,
    ) -> Mesh:
        """The voxels of an array of labels whose label is not zero: ``array[i, j, k]`` is the one from (i, j, k) to (i + 1, j + 1, k + 1).

        Args:
            array: Integers or flags, of three axes, or of two for a plane mesh.
            spacing: The length of a voxel, m, one for all axes or one for each.
            labels: By name of the group, a label or a list of them; others are left out. Without it each label is a group, ``"label=3"``.
            element: "hex8" (the default), or "tet4", which divides each voxel into six; "quad4" in the plane.
            origin: The place of the corner of ``array[0, 0, 0]``, m.

        Raises:
            SpringfitError: The array has no integers or no voxel, a label is in no voxel, or an argument is wrong.

        Examples:
            >>> import numpy as np, springfit as sf
            >>> scan = np.zeros((4, 3, 3), int)
            >>> scan[1:, :, :] = 1
            >>> scan[2, 1, 1] = 7
            >>> mesh = sf.Mesh.voxels(scan, spacing=[1e-3, 1e-3, 2e-3], labels={"bone": 7, "tissue": 1})
            >>> mesh, mesh.cell_groups["bone"].size
            (<springfit.Mesh: 64 points in 3 dimensions, 27 hex8>, 1)
        """
        core = _convert.voxels(array, spacing, labels, element, origin)
        return cls._of(core)

    @property
    def dimension(self) -> int:
        """Of the space: 1, 2 or 3."""
        return self._core.dimension

    @property
    def points(self) -> np.ndarray:
        """Coordinates, m, shape (points, dimension). Points that belong to no cell have been left out, see :attr:`numbers`. Places of points
        in ``fix``, and rows of forces, displacements and networks, are those of this array."""
        return self._kept("points", lambda: _fixed(self._core.points))

    @property
    def cells(self) -> Cells:
        """The nodes of the cells by the name of their element: ``mesh.cells["tet4"]`` of shape (cells, 4). Cells that were numbered the other way
        round have been turned."""
        return self._kept("cells", lambda: Cells(self._core.blocks))

    @property
    def cells_dict(self) -> dict[str, np.ndarray]:
        """:attr:`cells` as a dictionary, under the name that it has in meshio. Names of elements are those of springfit."""
        return dict(self.cells)

    @property
    def groups(self) -> dict[str, np.ndarray]:
        """The points of each group, ascending."""
        return dict(self._kept("groups", lambda: {name: _fixed(own) for name, own in self._core.groups.items()}))

    @property
    def cell_groups(self) -> dict[str, np.ndarray]:
        """The cells of each group that has some, ascending, counted block after block."""
        return dict(self._kept("cell_groups", lambda: {name: _fixed(own) for name, own in self._core.cell_groups.items()}))

    @property
    def centers(self) -> np.ndarray:
        """The middle of each cell, the mean of its nodes, m, shape (cells, dimension), block after block. Values by cell are in this order."""
        points = self.points
        return np.concatenate([points[nodes].mean(axis=1) for nodes in self.cells.values()])

    @property
    def volume(self) -> float:
        """The content of all cells: m³ of solids, m² of plane bodies and surfaces, m of curves."""
        return self._core.content

    @property
    def parents(self) -> np.ndarray | None:
        """Of a mesh by :meth:`boundary`, the cell of the body behind each cell, counted block after block; None of others."""
        return self._parents

    @property
    def normals(self) -> np.ndarray:
        """Unit normals of the cells of a surface in space or a curve in the plane, (cells, dimension), block after block. Those of
        :meth:`boundary` point out of the body; of curved cells they are those of their corners.

        Raises:
            SpringfitError: The cells have another dimension.
        """
        return _convert.normals(self)

    def refine(self, n: int = 1) -> Mesh:
        """The mesh with the edges of all cells halved ``n`` times, with the same groups. A tetrahedron becomes eight.

        Raises:
            SpringfitError: A cell cannot be divided, or ``n`` is not from 1 to 6.

        Examples:
            >>> import springfit as sf
            >>> sf.Mesh.box("tet4", size=[1, 1, 1], cells=[1, 1, 1]).refine()
            <springfit.Mesh: 27 points in 3 dimensions, 48 tet4>
        """
        times = count("n", n)
        if times > MOST:
            raise failure("n", f"a number from 1 to {MOST}", times)
        core = self._core
        for _ in range(times):
            core = core.refined()
        return Mesh._of(core)

    def boundary(self) -> Mesh:
        """The surface of a solid, or the curve around a plane body: a mesh of the sides that belong to one cell alone.

        Its :attr:`numbers` are the places of its points in :attr:`points` of the body, :attr:`parents` the cells behind its cells, and
        :attr:`normals` point outwards. It has the groups of the body.

        Raises:
            SpringfitError: No shipped element has the functions of a side.

        Examples:
            >>> import springfit as sf
            >>> body = sf.Mesh.box("hex8", size=[1, 1, 1], cells=[2, 2, 2])
            >>> surface = body.boundary()
            >>> surface, round(surface.volume, 9)
            (<springfit.Mesh: 26 points in 3 dimensions, 24 quad4>, 6.0)
            >>> bool((body.points[surface.numbers] == surface.points).all())
            True
        """
        found = self._core.boundary()
        blocks = [(Element(name), nodes) for name, nodes, _ in found]
        surface = Mesh._of(_core.Mesh.of_arrays(self.points, blocks, self.groups, {}, None, 0.0))
        surface._parents = _fixed(np.concatenate([behind for _, _, behind in found]))
        return surface

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the mesh in the format of the ending: ``.inp``, a deck of Abaqus with groups as sets of nodes and elements, or one that
        ``meshio`` writes, such as ``.vtu`` or ``.msh``, without groups, as a warning tells.

        Raises:
            SpringfitError: The format has no such cell, or meshio is not installed or has no such format.

        Examples:
            >>> import os, springfit as sf, tempfile
            >>> path = os.path.join(tempfile.mkdtemp(), "box.inp")
            >>> mesh = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[1, 1, 1])
            >>> mesh.save(path)
            >>> sf.Mesh.read(path).groups["xmin"].size
            4
        """
        _convert.save(self, os.fspath(path))

    def to_meshio(self) -> meshio.Mesh:
        """A ``meshio.Mesh`` with groups as point sets, and those of cells as cell sets.

        Raises:
            SpringfitError: meshio has no such cell.

        Examples:
            >>> import springfit as sf
            >>> sorted(sf.Mesh.box("tet4", size=[1, 1, 1], cells=[1, 1, 1]).to_meshio().cells_dict)
            ['tetra']
        """
        return _convert.to_meshio(self)

    def to_pyvista(self, u: Any = None) -> pyvista.UnstructuredGrid:
        """A ``pyvista.UnstructuredGrid``, with groups of cells as ``cell_data`` of flags.

        Args:
            u: Displacements, m, (points, dimension), which become ``point_data["u"]``, (points, 3): ``grid.warp_by_vector("u")`` moves the points.

        Raises:
            SpringfitError: VTK has no such cell, or ``u`` has another shape.

        Examples:
            >>> import numpy as np, springfit as sf
            >>> mesh = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[1, 1, 1])
            >>> mesh.to_pyvista(np.zeros((8, 3))).n_cells
            6
        """
        return _convert.to_pyvista(self, u)

    @property
    def numbers(self) -> np.ndarray | None:
        """The number of each point where it comes from: its place in the array or the VTK file, or its Gmsh tag."""
        return self._core.numbers

    @property
    def quality(self) -> dict:
        """What was found about the cells: the worst quality, and how many are poor, left out, turned, hanging, in how many pieces."""
        return self._core.quality

    def _kept(self, key: str, make: Any) -> Any:
        """What is made once: it never changes."""
        known = self.__dict__.setdefault("_known", {})
        if key not in known:
            known[key] = make()
        return known[key]

    def __getstate__(self) -> dict:
        return {"_core": self._core, "_parents": self._parents}

    def __repr__(self) -> str:
        cells = ", ".join(f"{len(nodes)} {name}" for name, nodes in self.cells.items())
        return f"<springfit.Mesh: {len(self.points)} points in {self.dimension} dimensions, {cells}>"

    def _repr_html_(self) -> str:
        from html import escape

        extent = " × ".join(f"{length:.4g}" for length in np.ptp(self.points, axis=0))
        rows = [("points", str(len(self.points)))] + [(name, str(len(nodes))) for name, nodes in self.cells.items()]
        rows += [("extent, m", extent), ("groups", ", ".join(self.groups) or "none")]
        if self.quality["worst"] is not None:
            rows.append(("worst quality", f"{self.quality['worst']:.3g}"))
        body = "".join(f"<tr><th style='text-align:left'>{escape(k)}</th><td>{escape(v)}</td></tr>" for k, v in rows)
        return f"<table><caption>mesh in {self.dimension} dimensions</caption>{body}</table>"


def _fixed(values: np.ndarray) -> np.ndarray:
    """An array that nobody writes into, for it would change nothing else."""
    values.flags.writeable = False
    return values


def _points(values: Any) -> np.ndarray:
    """Coordinates of points, (points, dimension)."""
    found = matrix("points", values, np.float64)
    if found.shape[1] not in (1, 2, 3):
        hint = " (transposed? points.T has a point in each row)" if found.shape[0] in (1, 2, 3) else ""
        raise failure("points", "an array of shape (points, 1, 2 or 3)", f"one of shape {found.shape}{hint}")
    return found


def _flag(key: str, value: Any) -> bool:
    if not isinstance(value, (bool, np.bool_)):
        raise failure(key, "True or False", shown(value))
    return bool(value)


def _gate(below: Any, least: Any) -> tuple[str | None, float | None]:
    least = None if least is None else number("least", least, "a quality from 0 to 1")
    return word("below", below, '"warn", "refuse" or "skip"'), least


def _is_number(text: str) -> bool:
    """Whether a text is a number without a unit."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def _scale(scale: Any) -> float:
    expected = "metres per mesh unit, a number above zero or a unit such as \"mm\""
    found = measure("scale", scale, expected, "mesh unit")
    if not 0.0 < found < float("inf"):
        raise failure("scale", expected, found)
    return found


def _blocks(cells: Any, own: list[Element]) -> list[tuple[Element, np.ndarray]]:
    """Elements and the nodes of their cells. Those of one element are put together, so that a name tells them."""
    expected = "a dictionary of nodes by element, or a list of pairs of both"
    if not isinstance(cells, Iterable):
        raise failure("cells", expected, shown(cells))
    pairs = list(cells.items() if isinstance(cells, Mapping) else cells)
    if not all(isinstance(pair, (tuple, list)) and len(pair) == 2 for pair in pairs):
        raise failure("cells", expected, shown(cells))
    named = {element.name: element for element in reversed(own)}
    found: dict[str, tuple[Any, Element, list[np.ndarray]]] = {}
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

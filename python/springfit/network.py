"""Fits, and the networks of springs that they give."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core
from ._arguments import array, failure, matrix, number, shown, typed, warn
from ._functions import separated, warn_of_rest
from ._lazy import Package
from ._progress import listener
from .material import Material, MaterialLike, default_law, is_regions
from .mesh import Mesh

if TYPE_CHECKING:
    import pyvista
    from scipy.sparse import csr_matrix
else:
    pyvista, csr_matrix = Package("pyvista"), Any

#: How many points an error names.
NAMED = 8


def fit(
    mesh: Mesh,
    material: MaterialLike,
    objective: str = "exact",
    *,
    springs: "list[str] | None" = None,
    fix: Any = None,
    progress: "bool | Callable[[str, int, int], Any]" = False,
    **keys: Any,
) -> "Network":
    """Fits the springs of every cell, and puts them together.

    Args:
        mesh: The body.
        material: What it is made of: a :class:`Material`, or a dictionary of them by group for a body of regions, None standing for the rest.
        objective: "exact" (the default: the network is the finite element), "frobenius", "offdiag", "modal", "spectral",
            "divergence", "sampled", or a published method.
        springs: Names of spring groups; all that are not optional, if None.
        fix: What is held in a fit to the whole object, as in :meth:`Network.solve`; such fits alone have it.
        progress: True shows a bar (by ``tqdm`` where it is installed); or a function of (stage, done, total).
        **keys: The other keys of a ``[[fit]]`` in a scene, such as ``nonnegative=True`` or ``volume="patches"``.

    Returns:
        The network, whose points are those of the mesh.

    Raises:
        SpringfitError: A key or a value is wrong, or a cell cannot be fitted.
    """
    check_body(mesh, material)
    entry: "dict[str, Any]" = {"objective": objective, "springs": springs, **keys}
    if fix is not None and objective != "whole":
        raise failure("fix", 'what is held with the objective "whole" alone', f'it with "{objective}"')
    held = None if fix is None else held_flags(mesh, fix)
    entry, functions = separated(entry)
    if functions is not None and functions["energy"] is not None:
        warn_of_rest(material, *functions["energy"][1:])
    with listener(progress) as told:
        return Network(_core.fit(mesh._core, material, entry, held, told, functions), mesh)


def sampled(
    mesh: Mesh,
    material: MaterialLike,
    law: "str | os.PathLike[str] | Callable[[np.ndarray], Any] | None" = None,
    *,
    stress: "Callable[[np.ndarray], Any] | None" = None,
    force: "str | Callable[..., Any] | Mapping[str, str | Callable[..., Any]] | None" = None,
    norm: "str | Callable[[np.ndarray], Any] | None" = None,
    **keys: Any,
) -> "Network":
    """Fits the springs of every cell to the forces of an energy at sampled shapes.

    Args:
        law: That of the material if None. A shipped energy, such as "neo-hookean", or the path of a material file, whose expression is differentiated exactly. Or a
            function W(F) of the deformation gradients (n, 3, 3) that returns the energies per volume at rest (n,), J/m³. F is that of a
            solid; of a plane body its stretch through the thickness follows from the plane state. Without ``stress``, W is differentiated
            by differences of the fourth order, whose error is some 1e-12 of the moduli. The material gives the moduli at rest; a warning tells where W has others.
        stress: The derivative P(F) of W, (n, 3, 3), Pa: the first Piola-Kirchhoff stress. It is enough without W; with W both are compared.
        force: The law of force of the springs: an expression, such as "k1*s + k3*s^3", or a function such as f(s, k, a), or a dictionary of
            laws by spring group. Arguments of a function are the strain s = (c - c0)/c0 and the measure c, of shape (n,), the measure c0 at
            rest, and the parameters to fit, which are numbers and have any other names; those with a default keep it. It returns the
            forces (n,), N. Its derivatives are differences.
        norm: What is minimised: "2", "1", "max", "huber", or a function of the residual forces of a cell, (shapes, nodes, d), each shape
            times the root of its weight; with ``higher`` below 1, d more rows follow. It returns a pair: the value, or one of each shape
            (shapes,), which are added, and its gradient in the residuals. It belongs to laws that are linear in their parameters.
        **keys: The other keys of a ``[[fit]]`` with the objective "sampled", such as ``shapes={"count": 300, "stretch": 0.3}``; and the
            options of :func:`fit`. ``shapes`` may have a ``sampler`` in place of families: a function of a number and a
            ``numpy.random.Generator`` that returns as many deformation gradients, (count, d, d); also in its ``held_out``.

    Functions are called on the threads of the fit, one call at a time. What they raise is the cause of the error. A network whose law of
    force is a function is not written to files.

    Raises:
        SpringfitError: A key or a value is wrong, a function fails or returns an array of another shape, or a cell cannot be fitted.
    """
    if law is None and isinstance(material, Material) and stress is None:
        law = default_law(material)
    law = law if law is None or callable(law) else os.fspath(law)
    return fit(mesh, material, "sampled", law=law, stress=stress, force=force, norm=norm, **keys)


def whole(mesh: Mesh, material: MaterialLike, fix: Any, **keys: Any) -> "Network":
    """Fits the springs of all cells together to the displacements of the whole object.

    Args:
        fix: What is held: the name of a group, places of points, a flag for each point, or for each component (points, dimension). Points
            are numbered as in :attr:`Mesh.points`, without those that belong to no cell.
        **keys: The other keys of a ``[[fit]]`` with the objective "whole", such as ``unknowns="groups"``; and the options of :func:`fit`.

    Raises:
        SpringfitError: A key or a value is wrong, or nothing holds a piece of the mesh.
    """
    return fit(mesh, material, "whole", fix=fix, **keys)


def check_body(mesh: Any, material: Any) -> None:
    """Raises where one is not what its name says."""
    if not isinstance(mesh, Mesh):
        raise failure("mesh", "a springfit.Mesh, such as Mesh(points, {element: cells})", shown(mesh))
    if not isinstance(material, Material) and not is_regions(material):
        expected = "a springfit.Material, such as Material(young=1e4, poisson=0.3), or a dictionary of them by group"
        raise failure("material", expected, shown(material))


def held_flags(mesh: Mesh, fix: Any) -> np.ndarray:
    """Which components ``fix`` holds, (points, dimension)."""
    shape = mesh.points.shape
    held = np.zeros(shape, dtype=bool)
    if isinstance(fix, str):
        groups = mesh.groups
        if fix not in groups:
            known = "a group of the mesh: " + ", ".join(groups) if groups else "places of points or flags, as the mesh has no groups"
            raise failure("fix", known, shown(fix))
        fix = groups[fix]
    if fix is None:
        raise failure("fix", "what is held", "nothing")
    fix = array("fix", fix)
    if fix.dtype == bool and fix.shape in (shape, shape[:1]):
        held[fix] = True
    elif fix.ndim == 1 and (fix.size == 0 or fix.dtype.kind in "iu"):
        outside = fix[(fix < 0) | (fix >= shape[0])] if fix.size else fix
        if outside.size:
            raise failure("fix", f"places of points from 0 and below {shape[0]}", outside[0])
        held[fix.astype(np.int64)] = True
    else:
        expected = f"a group's name, places of points below {shape[0]}, or flags of shape {shape[:1]} or {shape}"
        raise failure("fix", expected, f"values of type {fix.dtype}, shape {fix.shape}")
    return held


def stiffness(mesh: Mesh, material: MaterialLike) -> "csr_matrix":
    """The stiffness matrix of the finite elements, N/m: a ``scipy.sparse.csr_matrix`` of shape (points·dimension, points·dimension).

    The degree of freedom of point p along axis k has the number ``p * dimension + k``.
    """
    check_body(mesh, material)
    return _sparse(_core.finite_elements(mesh._core, material), mesh.points.size)


def mass(mesh: Mesh, material: MaterialLike, share: float = 0.0, total: "float | None" = None) -> "csr_matrix":
    """The mass matrix ``(1 - share) * M + share * diag(m)``, kg: a ``scipy.sparse.csr_matrix``, numbered as in :func:`stiffness`.

    ``M_ab = ∫ ρ N_a N_b dV`` is the consistent matrix of the finite elements, and ``m`` its diagonal with the mass of each cell (HRZ).

    Args:
        share: From 0 to 1; whole-object fits report it as ``lumped_share``, fitted to frequencies.
        total: The mass of the body, kg, where that of its mesh is another; whole-object fits report it as ``total``.

    Raises:
        SpringfitError: The material has no density, or a value is outside its range.
    """
    check_body(mesh, material)
    own = _sparse(_core.masses(mesh._core, material, number("share", share, "a number from 0 to 1")), mesh.points.size)
    if total is None:
        return own
    wanted = number("total", total, "a mass above zero, kg")
    if not 0.0 < wanted < float("inf"):
        raise failure("total", "a mass above zero, kg", wanted)
    # Each axis has the mass once.
    return own * (wanted * mesh.points.shape[1] / own.sum())


def _sparse(triplets: tuple, size: int) -> "csr_matrix":
    from scipy.sparse import csr_matrix

    rows, columns, values = triplets
    return csr_matrix((values, (rows, columns)), shape=(size, size))


class Network:
    """Springs on the points of a mesh, as :func:`fit` gives them."""

    def __init__(self, core: "_core.Network", mesh: Mesh) -> None:
        self._core, self.mesh = core, mesh

    @property
    def points(self) -> np.ndarray:
        """Positions at rest, m, shape (points, dimension)."""
        return self._core.points

    @property
    def springs(self) -> np.ndarray:
        """The two points of each spring between two points, int32, shape (springs, 2)."""
        return self._core.springs

    @property
    def constants(self) -> np.ndarray:
        """k of each such spring, N/m: its energy is ``k (l - rest)²/2``."""
        return self._core.constants

    @property
    def rest(self) -> np.ndarray:
        """The length of each such spring where it does not pull, m; zero for springs of exact networks."""
        return self._core.rest

    @property
    def contents(self) -> "list[dict]":
        """The springs on areas, volumes, angles and other measures c of a few points, gathered by kind: a dictionary of ``kind``, ``points``
        (springs, points of each), ``constants``, ``rest`` (energy ``k (c - rest)²/2``) and the ``unit`` of the constant. With a ``law``
        of force its ``parameters`` are a dictionary of arrays by name, and the constant is the slope at rest; springs between two points
        that have a law are here as well.

        The area or volume of a whole cell is ``c = Σ_q w_q det(Σ_a x_a ⊗ ∇N_a(ξ_q))``, with the points and weights of the quadrature of its
        element (``hex8``: 2×2×2 points of Gauss); of a simplex it is the determinant of the edges, divided by 2 or 6. Measures at a quadrature
        point have ``weights`` and ``gradients`` G (springs, points·columns): c is ``weight`` times the content of ``Σ x_a ⊗ G_a``. Patches
        have ``cells``: lists of (nodes, share), nodes being places in the row of ``points``."""
        return self._core.others

    @property
    def masses(self) -> "np.ndarray | None":
        """kg, shape (points,); None where the material has no density.

        They are the row sums ``m_a = ∫ ρ N_a dV`` of the mass matrix. If one of them is not positive, as at the corners of ``tet10``, all are
        those of the HRZ method: the diagonal of the matrix with the mass of each cell, as in ``mass(..., share=1)``."""
        return self._core.masses

    @property
    def statistics(self) -> dict:
        """Seconds, counts, and the mean and largest ‖R−K‖/‖R‖ of the cells in both norms, which are computed when this is first read."""
        return self._core.statistics

    @property
    def sampled(self) -> "dict | None":
        """The errors of a sampled fit, as in ``report.json``: ``trained``, ``held_out``, ``families``, ``starts`` and more; None of other fits.

        With ``data=True`` in the fit, ``errors`` has the error of each shape of one cell of each shape and ``ends`` the end of each start,
        as dictionaries of columns that ``pandas.DataFrame`` takes (but ``stretches``, the least and the largest one, (n, 2)).
        """
        found = self._core.sampled
        if found is None:
            return None
        text, errors, ends = found
        return {**json.loads(text), "errors": errors, "ends": ends}

    @property
    def status(self) -> str:
        """One word for the state of the fit."""
        return self._core.status

    @property
    def notes(self) -> "list[str]":
        """What a reader must know before the figures are trusted."""
        return self._core.notes

    def __len__(self) -> int:
        return len(self._core)

    def energy(self, x: Any = None) -> float:
        """The energy at positions ``x`` (points, dimension), J; at rest if None."""
        return self._core.energy(None if x is None else matrix("x", x, np.float64))

    def forces(self, x: Any = None) -> np.ndarray:
        """The forces of the springs on the points at positions ``x``, N: minus the gradient of :meth:`energy`."""
        return self._core.forces(None if x is None else matrix("x", x, np.float64))

    def stiffness(self, x: Any = None) -> "csr_matrix":
        """The tangent stiffness at positions ``x`` (at rest if None), N/m, a ``scipy.sparse.csr_matrix``; numbered as in :func:`stiffness`."""
        triplets = self._core.stiffness(None if x is None else matrix("x", x, np.float64))
        return _sparse(triplets, self.points.size)

    def solve(self, *, fix: Any, forces: Any = None, displacement: Any = None) -> np.ndarray:
        """Small displacements of the network, m, shape (points, dimension).

        Args:
            fix: What is held: the name of a group, places of points, a flag for each point, or for each component (points, dimension).
                Points are numbered as in :attr:`points`, without those that belong to no cell (:attr:`Mesh.numbers`).
            forces: On the points, N, (points, dimension); none if None.
            displacement: Of what is held, m, (points, dimension), zero elsewhere; zero if None.

        Raises:
            SpringfitError: A motion has no stiffness, an array has a wrong shape, or a displacement is given of what is not held.
        """
        shape = self.points.shape
        held = held_flags(self.mesh, fix)
        zero = np.zeros(shape)
        given = [zero if array is None else matrix(key, array, np.float64)
                 for key, array in (("forces", forces), ("displacement", displacement))]
        if given[1].shape == shape:
            loose = np.flatnonzero(((given[1] != 0) & ~held).any(axis=1))
            if loose.size:
                named = ", ".join(map(str, loose[:NAMED])) + (", …" if loose.size > NAMED else "")
                raise failure("displacement", "zero wherever fix does not hold", f"others at {loose.size} points: {named}")
        u, left, is_stable = self._core.solve(given[0], held, given[1])
        if not is_stable:
            warn("the network is indefinite with these supports: some motion releases energy")
        if not left < 1e-6:
            warn(f"the solution leaves {left:.1e} of the forces: the network is nearly a mechanism")
        return u

    def write(self, path: "str | os.PathLike[str]") -> None:
        """Writes the springs to a ``.json``, ``.npz``, ``.vtu`` or ``.csv`` file; nothing is half written."""
        self._core.write(os.fspath(path))

    def export(self, to: str, folder: "str | os.PathLike[str]", *, gravity: Any = None) -> "list[Path]":
        """Writes the files and scripts of another program, as ``springfit export``.

        Args:
            to: The program: "mujoco", "newton", "lammps", "jolt", "xpbd", "sofa", "blender", "phystwin", "npz" or "vtu".
            folder: Where they go; it is made.
            gravity: m/s², shape (dimension,); 9.81 against the last axis if None.

        Returns:
            The files. A warning names what the program does not represent, and what a held body does at rest that it would not move as the
            network does.

        Raises:
            SpringfitError: The program does not hold this network, and a fit that it holds is named; or cells turn inside out under gravity.
        """
        along = None if gravity is None else typed("gravity", array("gravity", gravity), np.float64).tolist()
        files, left_out, _ = self._core.export(to, os.fspath(folder), along)
        for words in left_out:
            warn(words)
        return [Path(file) for file in files]

    def to_pyvista(self) -> "pyvista.PolyData":
        """Lines with their constants and rest lengths, as ``pyvista.PolyData``: all springs on lengths, those of :attr:`springs` first. Springs with a
        law of force, which :attr:`contents` has, follow; their constant is the slope at rest."""
        import pyvista

        points = np.zeros((len(self.points), 3))
        points[:, : self.mesh.dimension] = self.points
        others = [kind for kind in self.contents if kind["kind"] == "length"]
        ends = np.concatenate([self.springs, *(kind["points"] for kind in others)])
        lines = np.column_stack([np.full(len(ends), 2), ends])
        data = pyvista.PolyData(points, lines=lines.ravel())
        data.cell_data["constant"] = np.concatenate([self.constants, *(kind["constants"] for kind in others)])
        data.cell_data["rest"] = np.concatenate([self.rest, *(kind["rest"] for kind in others)])
        return data

    def __repr__(self) -> str:
        name = self._core.name
        others = "".join(f", {len(kind['constants'])} {kind['kind']}" for kind in self.contents)
        return f"<springfit.Network {name}: {len(self.points)} points, {len(self.springs)} springs{others}>"

    def _repr_html_(self) -> str:
        from html import escape

        statistics = self.statistics
        rows: "list[tuple[str, object]]" = [("points", len(self.points)), ("springs between two points", len(self.springs))]
        rows += [(f"{kind['kind']} springs", len(kind["constants"])) for kind in self.contents]
        rows += [("constants below zero", statistics["negative"])]
        for norm in ("frobenius", "spectral"):
            if statistics[norm] is not None:
                mean, largest = statistics[norm]
                rows.append((f"‖R−K‖/‖R‖, {norm}: mean, largest", f"{mean:.3g}, {largest:.3g}"))
        rows += [("fitted in", f"{statistics['seconds']:.3g} s"), ("status", statistics["status"])]
        body = "".join(f"<tr><th style='text-align:left'>{escape(str(k))}</th><td>{escape(str(v))}</td></tr>" for k, v in rows)
        notes = "".join(f"<li>{escape(note)}</li>" for note in self.notes)
        return f"<table><caption>{escape(statistics['name'])}</caption>{body}</table><ul>{notes}</ul>"

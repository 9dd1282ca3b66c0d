"""Networks of springs on points."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np

from . import _core
from ._arguments import ElementLike, array, elements_of, failure, matrix, shown, typed, warn
from ._contents import changed_groups, given_groups, numbers, places_of_points
from ._lazy import Package
from ._network_state import GIVEN, STATISTICS, frozen, lines, restored, state, table
from ._npz import mesh_of, read_arrays
from ._sparse import csr
from ._supports import check_acting, displacement_of, forces_of, held_flags, one_of_each, vectors
from .factorized import Factorized
from .mesh import Mesh
from .motion import Motion, simulate

if TYPE_CHECKING:
    import pyvista
    from scipy.sparse import csr_matrix
else:
    pyvista, csr_matrix = Package("pyvista"), Any


class Network:
    """Springs on points: those of a fit, as :func:`fit` gives them, of a file (:meth:`load`), or of arrays.

    Args:
        points: Positions at rest, m, shape (points, dimension).
        springs: The two points of each spring between two points, shape (springs, 2).
        constants: k of each such spring, N/m.
        rest: The length of each such spring where it does not pull, m; the distance of its points if None.
        contents: The springs on areas, volumes, angles and other measures, a list of dictionaries as in :attr:`contents`. ``kind``, ``points`` and
            ``constants`` are required; without ``rest`` it is the measure at ``points``. "area" of three points in the plane and "volume" of
            four points in space need no more; cells of another element need its name as ``element``.
        masses: Of the points, kg, shape (points,).
        mesh: The cells on the same points, whose groups ``fix`` and ``forces`` may name.

    The energy is ``Σ k (l - rest)²/2`` over springs between two points, and the same sum over other measures. Arrays of a network are made once and are
    read-only; :meth:`with_constants` gives a network with other numbers. It is pickled and copied as it is. Places of points are int64, as in
    ``Mesh.cells`` and ``SpringConstants``: the type with which NumPy indexes.

    >>> import springfit as sf
    >>> net = sf.Network([[0, 0], [1, 0], [0, 1]], [[0, 1], [1, 2], [2, 0]], [10.0, 10.0, 10.0])
    >>> net.solve(fix=[[True, True], [False, True], [True, False]], forces=[[0, 0], [1e-2, 0], [0, 0]])[1].round(6).tolist()
    [0.00075, 0.0]

    Raises:
        SpringfitError: An array has a wrong shape or type, or a place is not that of a point.
    """

    #: What is known beside arrays, as the core writes it.
    _known: "str | None" = None

    def __init__(
        self,
        points: Any,
        springs: Any,
        constants: Any,
        *,
        rest: Any = None,
        contents: "Sequence[Mapping[str, Any]] | None" = None,
        masses: Any = None,
        mesh: "Mesh | None" = None,
    ) -> None:
        if not isinstance(mesh, (Mesh, type(None))):
            raise failure("mesh", "a springfit.Mesh on the same points", shown(mesh))
        k = numbers("constants", constants)
        if k is None:
            raise failure("constants", "an array of numbers, N/m", "nothing")
        ends = places_of_points("springs", springs if np.size(springs) else np.zeros((0, 2), np.int64))
        if ends.shape[1] != 2:
            raise failure("springs", "an array of shape (springs, 2)", f"one of shape {ends.shape}")
        points = matrix("points", points, np.float64)
        groups = given_groups(contents)
        given = (points, ends, k, numbers("rest", rest), groups, numbers("masses", masses))
        self._keep(_core.Network.of_arrays(*given, None if mesh is None else mesh._core, self._known), mesh, GIVEN)

    def _keep(self, core: "_core.Network", mesh: "Mesh | None", facts: "dict[str, Any] | None") -> None:
        # Facts are those of networks that were no fit of this process.
        self._core, self._mesh, self._facts = core, mesh, facts
        self._made: "dict[str, Any]" = {}

    @classmethod
    def _of(cls, core: "_core.Network", mesh: "Mesh | None", facts: "dict[str, Any] | None" = None) -> "Network":
        net = cls.__new__(cls)
        net._keep(core, mesh, facts)
        return net

    @classmethod
    def _given(cls, *arrays: Any, known: "str | None" = None, **keys: Any) -> "Network":
        # What is known beside the arrays, as the core writes it.
        net = cls.__new__(cls)
        net._known = known
        cls.__init__(net, *arrays, **keys)
        return net

    @classmethod
    def load(cls, path: "str | os.PathLike[str]", *, elements: "Sequence[ElementLike]" = ()) -> "Network":
        """The network of a ``.json`` or ``.npz`` file of :meth:`save`, ``springfit run`` or ``springfit fit``.

        It has its points, springs, masses and, where their elements are known, its cells as :attr:`mesh`. The thickness, the settings of an engine and,
        of a ``.json`` file, supports, loads, damping and relaxation are not seen here, and are in the files that :meth:`save` and :meth:`export` write.

        Args:
            elements: Element files, or elements, of cells that are not shipped.

        Raises:
            SpringfitError: The file is no network or contradicts itself, or has springs on cells of an unknown element.
        """
        path = os.fspath(path)
        ending = os.path.splitext(path)[1]
        if ending == ".npz":
            given, cells, known = read_arrays(path)
            mesh = mesh_of(given["points"], cells)
            return cls._given(**given, mesh=mesh, known=known)
        if ending != ".json":
            expected = "a file ending in .json or .npz, which hold a whole network"
            raise failure("path", expected, path, "unsupported")
        core, mesh, (name, status, notes) = _core.Network.read(path, elements_of(elements))
        facts = {**GIVEN, "name": name or GIVEN["name"], "status": status or GIVEN["status"], "notes": notes}
        return cls._of(core, None if mesh is None else Mesh._of(mesh), facts)

    def save(self, path: "str | os.PathLike[str]") -> None:
        """Writes the springs to a ``.json``, ``.npz``, ``.vtu`` or ``.csv`` file; nothing is half written.

        :meth:`load` reads the first two. ``.npz`` has springs between two points and on the contents of simplices alone; its array of :attr:`constants` is
        called ``k`` there, as programs read it that it is written for.

        Raises:
            SpringfitError: The format does not hold these springs, or the file cannot be written.
        """
        self._core.write(os.fspath(path))

    write = save

    def with_constants(
        self, constants: Any = None, *, rest: Any = None, contents: "Sequence[Any] | None" = None
    ) -> "Network":
        """The same springs with other numbers, such as those of a calibration elsewhere. All else that is known of the network stays.

        Args:
            constants: Of the springs between two points, N/m, shape (springs,); as they are if None.
            rest: Their lengths at rest, m.
            contents: One entry for each of :attr:`contents`: an array of constants, a dictionary of ``constants``, ``rest`` or ``parameters``, or None.

        Raises:
            SpringfitError: An array has a wrong length or type.
        """
        changed = self._core.changed(numbers("constants", constants), numbers("rest", rest), changed_groups(contents))
        return Network._of(changed, self._mesh, {**GIVEN, "name": self.name})

    @property
    def mesh(self) -> "Mesh | None":
        """The mesh on whose points the springs are; None of networks whose cells are not known."""
        return self._mesh

    @property
    def _groups(self) -> "dict[str, np.ndarray] | None":
        return None if self._mesh is None else self._mesh.groups

    def _once(self, name: str) -> Any:
        """An array of the compiled part, made once and read-only."""
        if name not in self._made:
            found = getattr(self._core, name)
            if isinstance(found, np.ndarray):
                found.flags.writeable = False
            self._made[name] = found
        return self._made[name]

    @property
    def points(self) -> np.ndarray:
        """Positions at rest, m, shape (points, dimension), read-only."""
        return self._once("points")

    @property
    def springs(self) -> np.ndarray:
        """The two points of each spring between two points, ascending, int64, shape (springs, 2), read-only."""
        return self._once("springs")

    @property
    def constants(self) -> np.ndarray:
        """k of each such spring, N/m, read-only: its energy is ``k (l - rest)²/2``."""
        return self._once("constants")

    @property
    def rest(self) -> np.ndarray:
        """The length of each such spring where it does not pull, m, read-only; zero for springs of exact networks."""
        return self._once("rest")

    @property
    def contents(self) -> "list[dict]":
        """The springs on areas, volumes, angles and other measures c of a few points, gathered by kind: a dictionary of ``kind``, ``points``
        (springs, points of each), ``constants``, ``rest`` (energy ``k (c - rest)²/2``) and the ``unit`` of the constant; arrays are read-only. With a
        ``law`` of force its ``parameters`` are a dictionary of arrays by name, and the constant is the slope at rest; springs between two points
        that have a law are here as well.

        The area or volume of a whole cell of an ``element`` is ``c = Σ_q w_q det(Σ_a x_a ⊗ ∇N_a(ξ_q))``, with the points and weights of its
        quadrature (``hex8``: 2×2×2 points of Gauss); of a simplex it is the determinant of the edges, divided by 2 or 6. Measures at a quadrature
        point have ``weights`` and ``gradients`` G (springs, points·columns): c is ``weight`` times the content of ``Σ x_a ⊗ G_a``. Patches
        have ``cells``: lists of (nodes, share), nodes being places in the row of ``points``. Other measures have an ``expression`` of the coordinates
        of their points, ``x0, y0, z0, x1, …``."""
        if "contents" not in self._made:
            self._made["contents"] = [frozen(group) for group in self._core.others]
        # A list and dictionaries of its own: what a caller puts there is not lost in those of the next.
        return [dict(group) for group in self._made["contents"]]

    @property
    def masses(self) -> "np.ndarray | None":
        """kg, shape (points,), read-only; None where the material has no density.

        They are the row sums ``m_a = ∫ ρ N_a dV`` of the mass matrix. If one of them is not positive, as at the corners of ``tet10``, all are
        those of the HRZ method: the diagonal of the matrix with the mass of each cell, as in ``mass(..., share=1)``."""
        return self._once("masses")

    @property
    def statistics(self) -> dict:
        """Seconds, counts, and the mean and largest ‖R−K‖/‖R‖ of the cells in both norms, which are computed when this is first read; they
        are None of networks that were not fitted here."""
        if self._facts is None:
            return self._core.statistics(True) or {}
        return {**STATISTICS, **self._facts["statistics"], "name": self.name, "status": self.status, "negative": self._core.negative}

    @property
    def sampled(self) -> "dict | None":
        """The errors of a sampled fit, as in ``report.json``: ``trained``, ``held_out``, ``families``, ``starts`` and more; None of other fits.

        With ``data=True`` in the fit, ``errors`` has the error of each shape of one cell of each shape and ``ends`` the end of each start,
        as dictionaries of columns that ``pandas.DataFrame`` takes (but ``stretches``, the least and the largest one, (n, 2)).
        """
        found = self._core.sampled if self._facts is None else self._facts["sampled"]
        if found is None:
            return None
        text, errors, ends = found
        return {**json.loads(text), "errors": errors, "ends": ends}

    @property
    def name(self) -> str:
        """The name of the fit; "given" of springs from arrays."""
        return str(self._core.name) if self._facts is None else self._facts["name"]

    @property
    def status(self) -> str:
        """One word for the state of the fit; "given" of springs from arrays."""
        return str(self._core.status) if self._facts is None else self._facts["status"]

    @property
    def notes(self) -> "list[str]":
        """What a reader must know before the figures are trusted."""
        return self._core.notes if self._facts is None else list(self._facts["notes"])

    def __len__(self) -> int:
        """The number of all springs, those of :attr:`contents` included."""
        return len(self._core)

    @overload
    def energy(self, x: None = None) -> float: ...
    @overload
    def energy(self, x: Any) -> Any: ...
    def energy(self, x: Any = None) -> Any:
        """The energy at positions ``x`` (points, dimension), J; at rest if None. Of several shapes (…, points, dimension) it is an array (…)."""
        if x is None:
            return float(self._core.energy(None)[0])
        x = vectors("x", x, self.points.shape)
        found = self._core.energy(x.reshape(-1, *x.shape[-2:]))
        return float(found[0]) if x.ndim == 2 else found.reshape(x.shape[:-2])

    def forces(self, x: Any = None) -> np.ndarray:
        """The forces of the springs on the points at positions ``x``, N: minus the gradient of :meth:`energy`. ``x`` may be several shapes
        (…, points, dimension), which are evaluated on all threads."""
        if x is None:
            return self._core.forces(None)[0]
        x = vectors("x", x, self.points.shape)
        return self._core.forces(x.reshape(-1, *x.shape[-2:])).reshape(x.shape)

    def stiffness(self, x: Any = None) -> "csr_matrix":
        """The tangent stiffness at positions ``x`` (at rest if None), N/m, a ``scipy.sparse.csr_matrix``; numbered as that of :func:`springfit.stiffness`."""
        rows = self._core.stiffness(None if x is None else one_of_each("x", x, self.points.shape))
        return csr(rows)

    def factorized(self, fix: Any) -> Factorized:
        """The stiffness at rest under a support, factorised once for many loads.

        >>> import numpy as np, springfit as sf
        >>> mesh = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[2, 2, 2])
        >>> net = sf.fit(mesh, sf.Material(young=1e4, poisson=0.3))
        >>> solve = net.factorized(fix="zmin")
        >>> loads = np.random.default_rng(0).uniform(-1, 1, (5, *net.points.shape))
        >>> solve(loads).shape, solve({"zmax": [0, 0, 1]}).shape
        ((5, 27, 3), (27, 3))

        Args:
            fix: As in :meth:`solve`.

        Raises:
            SpringfitError: A motion has no stiffness.
        """
        held = held_flags(self.points.shape, self._groups, fix)
        return Factorized(self, self._core.factorized(held), held)

    def solve(self, fix: Any, forces: Any = None, displacement: Any = None) -> np.ndarray:
        """Small displacements of the network, m, shape (points, dimension), or (loads, points, dimension) under several loads.

        Args:
            fix: What is held: the name of a group or a list of these, places of points, a flag for each point, or for each component
                (points, dimension). Points are numbered as in :attr:`points`, without those that belong to no cell (:attr:`Mesh.numbers`).
            forces: On the points, N, (points, dimension), or of several loads (loads, points, dimension); or a dictionary of total forces by group,
                such as ``{"xmax": [0, 0, 1]}``, which are shared by the shape functions as ``force`` of a scene; none if None.
            displacement: Of what is held, m, in the same shapes, zero elsewhere; or a dictionary of vectors by group; zero if None.

        A warning tells where strains or rotations are beyond the linear theory; :meth:`equilibrium` solves there.

        Raises:
            SpringfitError: A motion has no stiffness, an array has a wrong shape, or a displacement is given of what is not held.
        """
        return self.factorized(fix)(forces, displacement)

    def equilibrium(self, fix: Any, forces: Any = None, displacement: Any = None, *, x0: Any = None) -> np.ndarray:
        """The positions in equilibrium, m, (points, dimension), at any deformation: ``forces(x) + forces = 0`` where nothing is held.

        Newton's method with a line search, shifted tangents where the stiffness is not positive definite, and load steps that are halved
        where it does not converge.

        >>> import springfit as sf
        >>> mesh = sf.Mesh.box("tet4", size=[0.1, 0.02, 0.02], cells=[10, 2, 2])
        >>> net = sf.fit(mesh, sf.Material(young=10e3, poisson=0.3, density=1000.0))
        >>> x = net.equilibrium(fix="xmin", forces=net.masses[:, None] * [0, 0, -9.81])
        >>> bool(abs((net.forces(x) + net.masses[:, None] * [0, 0, -9.81])[net.points[:, 0] > 0]).max() < 1e-9)
        True

        Args:
            fix, forces, displacement: As in :meth:`solve`, of one load.
            x0: Positions near the equilibrium, (points, dimension), from which it is looked for first; those at rest if None.

        A warning tells where cells are turned inside out.

        Raises:
            SpringfitError: No equilibrium is found, an array has a wrong shape, or a displacement is given of what is not held.
        """
        shape = self.points.shape
        held = held_flags(shape, self._groups, fix)
        acting, moved = forces_of(self, forces), displacement_of(self, displacement, held)
        for key, given in (("forces", acting), ("displacement", moved)):
            if given.shape != shape:
                raise failure(key, f"an array of shape {shape}", f"one of shape {given.shape}")
        check_acting(acting[None], moved[None], held)
        start = None if x0 is None else one_of_each("x0", x0, shape)
        x, is_rounded, inverted = self._core.equilibrium(acting, held, moved, start)
        if inverted:
            warn(f"{inverted} cells are turned inside out in this equilibrium")
        if is_rounded:
            warn("rounding of the forces limits the accuracy of this equilibrium")
        return x

    def simulate(
        self,
        fix: Any = None,
        forces: Any = None,
        displacement: Any = None,
        *,
        dt: float,
        steps: int,
        x0: Any = None,
        v0: Any = None,
        method: 'Literal["implicit-euler", "bdf2", "newmark", "symplectic-euler"]' = "implicit-euler",
        damping: Any = None,
        gravity: Any = None,
        masses: Any = None,
        every: int = 1,
        callback: "Callable[[float, np.ndarray, np.ndarray], Any] | None" = None,
    ) -> "Motion | None":
        """The motion ``M a + C v = forces(x) + f`` from a state, at any deformation.

        >>> import springfit as sf
        >>> mesh = sf.Mesh.box("tet4", size=[0.1, 0.02, 0.02], cells=[10, 2, 2])
        >>> net = sf.fit(mesh, sf.Material(young=1e5, poisson=0.3, density=1000.0))
        >>> times, x, v = net.simulate(fix="xmin", gravity=[0, 0, -9.81], dt=1e-3, steps=100, every=10)
        >>> x.shape, float(times[-1])
        ((11, 99, 3), 0.1)

        Args:
            fix, forces, displacement: As in :meth:`solve`, of one load, at all times; nothing is held if ``fix`` is None.
            dt: The time of a step, s.
            steps: Their number.
            x0, v0: Positions, m, and velocities, m/s, at the start, (points, dimension); at rest if None.
            method: The integrator. The first three are implicit; "symplectic-euler" is explicit, and a step that is too long for it is refused.
            damping: A damping ratio of dampers beside the springs, or a pair of Rayleigh's numbers (1/s, s).
            gravity: m/s², (dimension,).
            masses: Of the points, kg; those of the network if None.
            every: So many steps are between two states that are kept; the first is the start.
            callback: Is called with the time, positions and velocities of these states, which are then not kept.

        Returns:
            Times, positions and velocities as a named tuple; None with a callback. What a callback raises is the cause of the error.

        Raises:
            SpringfitError: The step is too long, there are no masses, an array has a wrong shape, or the springs have no forces on the way.
        """
        shape = self.points.shape
        held = np.zeros(shape, bool) if fix is None else held_flags(shape, self._groups, fix)
        return simulate(
            self, held, forces, displacement, dt=dt, steps=steps, x0=x0, v0=v0, method=method, damping=damping, gravity=gravity, masses=masses,
            every=every, callback=callback,
        )

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
        """Lines with their ``constants`` and ``rest`` lengths, as ``pyvista.PolyData``: all springs on lengths, those of :attr:`springs` first.
        Springs with a law of force, which :attr:`contents` has, follow; their constant is the slope at rest."""
        return lines(self)

    def __reduce__(self) -> "tuple[Any, ...]":
        return restored, state(self)

    def __copy__(self) -> "Network":
        # It never changes.
        return self

    def __deepcopy__(self, memo: Any) -> "Network":
        return self

    def __repr__(self) -> str:
        kinds = [f"{len(self.springs)} between two points"]
        kinds += [f"{len(kind['constants'])} {kind['kind']}" for kind in self.contents]
        return f"<springfit.Network {self.name}: {len(self.points)} points, {len(self)} springs ({', '.join(kinds)})>"

    def _repr_html_(self) -> str:
        return table(self)

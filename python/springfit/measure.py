"""What a network is as a material and as a body, whoever made it."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Union

import numpy as np

from . import _core
from ._arguments import array, count, failure, matrix, number, places, shown
from ._contents import numbers
from .mesh import Mesh
from .network import Network


@dataclass(frozen=True)
class Elasticity:
    """An elasticity tensor and what it says.

    Attributes:
        stiffness: C in Kelvin's notation, σ = C ε, Pa, [strains, strains]: xx, yy, (zz,) √2 xy, (√2 xz, √2 yz). A plane network
            without a thickness is 1 m thick.
        young: The harmonic mean of Young's modulus over all directions, Pa; None if some strain meets no resistance.
        poisson: The mean of Poisson's ratio over all directions; None as ``young`` is.
        young_along: Young's modulus along each axis, Pa, [dimension]; None as ``young`` is.
        zener: Zener's ratio of a tensor with the symmetry of a cube or a square along the axes; None of others. 1 is isotropic.
        anisotropy: The distance ‖C − C_iso‖/‖C‖ from the nearest isotropic tensor.
        soft_strains: The number of strains that meet no resistance or release energy.
    """

    stiffness: np.ndarray
    young: "float | None"
    poisson: "float | None"
    young_along: "np.ndarray | None"
    zener: "float | None"
    anisotropy: float
    soft_strains: int


@dataclass(frozen=True)
class Region:
    """The material of some points of a network.

    Attributes:
        points: The number of points.
        volume: Their volume, m³: each has its share of the cells around it.
        affine: Where every point follows the strain. A spring belongs to its points in equal shares.
    """

    points: int
    volume: float
    affine: Elasticity


@dataclass(frozen=True)
class Measurement:
    """A network as a material and as a body.

    Attributes:
        affine: The material whose every point follows the strain: the energy of uniform strains over the volume (Voigt).
        relaxed: The material where points give way to each other: all of a period, or those inside a body whose boundary follows the
            strain; None where the boundary is not known.
        regions: The material of each region by its name.
        volume: m³; a plane network without a thickness is 1 m thick.
        volume_of: "cells", "period", "hull", "points" or "given".
        mass: kg; None without masses.
        density: kg/m³; None without masses.
        tension: How springs pull in this shape: ``springs`` that do, the ``largest`` pull in N, the share ``unbalanced`` at a point, and the
            mean ``stress`` in Kelvin's notation, Pa.
        releasing: The number of motions that release energy.
        mechanisms: The number of motions without resistance that are not rigid.
        rigid: The number of rigid motions that are left free.
        is_complete: Whether all motions are counted; of a large network there may be more.
        frequencies: The lowest frequencies that deform the network, Hz; None without masses.
        longest_step: The longest stable step of symplectic Euler without damping, s; None without masses.
        engine: The limit of the engine that is asked for: ``ceiling``, ``modulus`` in Pa and ``least_substeps``; None without one.
        notes: What a reader must know, a sentence each.
    """

    affine: Elasticity
    relaxed: "Elasticity | None"
    regions: "dict[str, Region]"
    volume: float
    volume_of: str
    mass: "float | None"
    density: "float | None"
    tension: "dict[str, Any] | None"
    releasing: int
    mechanisms: int
    rigid: int
    is_complete: bool
    frequencies: "np.ndarray | None"
    longest_step: "float | None"
    engine: "dict[str, Any] | None"
    notes: "list[str]"

    @property
    def is_stable(self) -> bool:
        """Whether every motion that is not rigid meets resistance."""
        return self.releasing == 0 and self.mechanisms == 0


def _elasticity(record: "dict[str, Any]") -> Elasticity:
    along = record["young_along"]
    return Elasticity(
        stiffness=np.array(record["stiffness"]),
        young=record["young"],
        poisson=record["poisson"],
        young_along=None if along is None else np.array(along),
        zener=record["zener"],
        anisotropy=record["anisotropy"],
        soft_strains=record["soft_strains"],
    )


def _measurement(text: str) -> Measurement:
    record = json.loads(text)
    relaxed, frequencies, stability = record["relaxed"], record["frequencies"], record["stability"]
    region = lambda own: Region(own["points"], own["volume"], _elasticity(own["affine"]))  # noqa: E731
    return Measurement(
        affine=_elasticity(record["affine"]),
        relaxed=None if relaxed is None else _elasticity(relaxed),
        regions={own["name"]: region(own) for own in record["regions"]},
        volume=record["volume"],
        volume_of=record["volume_of"],
        mass=record["mass"],
        density=record["density"],
        tension=record["tension"],
        frequencies=None if frequencies is None else np.array(frequencies),
        longest_step=record["longest_step"],
        engine=record["engine"],
        notes=record["notes"],
        **stability,
    )


def _contents(contents: Any) -> Any:
    if contents is None:
        return None
    if not isinstance(contents, (tuple, list)) or len(contents) != 3:
        raise failure("contents", "points, constants and rest contents", shown(contents))
    nodes, constants, rest = contents
    return matrix("contents", nodes, np.int64), numbers("contents constants", constants), numbers("contents rest", rest)


def measure(
    points: "Union[Network, str, os.PathLike[str], Any]",
    springs: Any = None,
    constants: Any = None,
    *,
    rest: Any = None,
    contents: Any = None,
    volumes: Any = None,
    mesh: "Mesh | None" = None,
    masses: Any = None,
    density: "float | None" = None,
    cell: Any = None,
    periodic: "bool | None" = None,
    table: "str | os.PathLike[str] | None" = None,
    fix: Any = None,
    regions: "Mapping[str, Any] | None" = None,
    plane: "str | None" = None,
    thickness: "float | None" = None,
    frequencies: int = 6,
    engine: "str | Mapping[str, Any] | None" = None,
) -> Measurement:
    """Measures a network: its elasticity tensor, moduli, density, tension at rest, stability, frequencies and longest step.

    With the stiffness K at rest, the unit strains U at the points and the volume V, C = Uᵀ K U/V where all points follow a strain
    (``affine``), and less where they give way to each other (``relaxed``).

    >>> import springfit as sf
    >>> mesh = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[2, 2, 2])
    >>> found = sf.measure(sf.fit(mesh, sf.Material(young=1e4, poisson=0.3)))
    >>> round(found.affine.young, 6), round(found.affine.poisson, 6)
    (10000.0, 0.3)

    Args:
        points: Positions [points, dimension], m; or a network; or the path of a file of springfit, PhysTwin, LAMMPS or MuJoCo.
        springs: Ends of the springs, places of points from 0, [springs, 2].
        constants: Their constants, N/m, [springs].
        rest: Their rest lengths, m, [springs]; the lengths where the points are, if there are none.
        contents: Springs on the areas of triangles (in the plane) or the volumes of tetrahedra: points [n, dimension + 1], constants in N/m³
            or N/m⁵, rest contents in m² or m³.
        volumes: The volume of each point, m³ (in the plane an area, m²), [points]; or of the whole network, one number; or "hull", that of the
            convex hull. Without it there must be a mesh or a cell.
        mesh: Cells on the same points, which give the volume and the boundary.
        masses: kg, [points].
        density: kg/m³, of a network without masses.
        cell: The vectors with which the network repeats itself, m, [dimension, dimension], a row each. Springs join the nearest images.
        periodic: Whether the network of a LAMMPS file repeats itself with its box; None lets the bonds tell.
        table: The file of the points of a table of springs.
        fix: Points that are held, or a flag for each: they do not move in frequencies.
        regions: Points by name, places or a flag for each.
        plane: "stress" or "strain", of a plane network.
        thickness: m, of a plane network.
        frequencies: So many are sought.
        engine: An engine by its name, or its settings as in a scene, such as {"method": "xpbd", "substeps": 20}.

    Raises:
        SpringfitError: An array has a wrong shape or a wrong number; the volume is not known; an image is not known, because the cell is
            shorter than twice a spring; an engine does not hold the network.
    """
    if engine is not None and not isinstance(engine, (str, Mapping)):
        raise failure("engine", "the name of an engine, or its settings", shown(engine))
    settings = {"method": engine} if isinstance(engine, str) else engine
    found = None if volumes is None or isinstance(volumes, str) else array("volumes", volumes)
    if isinstance(volumes, str) and volumes != "hull":
        raise failure("volumes", 'numbers, or "hull"', f'"{volumes}"')
    is_file = isinstance(points, (str, os.PathLike))
    of_network = isinstance(points, Network)
    total = len(points.points) if of_network else None if is_file else len(array("points", points))
    named = {} if regions is None else regions
    if not isinstance(named, Mapping):
        raise failure("regions", "a mapping of names to points", shown(named))
    options = {
        "volume": None if found is None or found.ndim else number("volumes", volumes, "a number, m³"),
        "hull": isinstance(volumes, str),
        "volumes": None if found is None or not found.ndim else numbers("volumes", found),
        "plane": plane,
        "thickness": None if thickness is None else number("thickness", thickness, "a number, m"),
        "density": None if density is None else number("density", density, "a number, kg/m³"),
        "regions": [
            (str(name), (places(f'regions["{name}"]', own, total) if total is not None else array("regions", own)).tolist())
            for name, own in named.items()
        ],
        "frequencies": count("frequencies", frequencies) if frequencies else 0,
        "engine": None if settings is None else json.dumps(dict(settings)),
    }
    vectors = None if cell is None else matrix("cell", cell, np.float64)
    for key, value in {"periodic": periodic, "table": table}.items():
        if value is not None and not is_file:
            raise failure(key, "nothing beside arrays or a network: it belongs to a file", shown(value))
    if is_file or of_network:
        given = {"springs": springs, "constants": constants, "rest": rest, "contents": contents, "mesh": mesh, "masses": masses, "fix": fix}
        for key, value in given.items():
            if value is not None:
                raise failure(key, "nothing beside a network or a file, which has its own", "a value")
    if is_file:
        return _measurement(_core.measure_file(os.fspath(points), table and os.fspath(table), vectors, periodic, options))
    if of_network:
        # Its file has all that is known of it: cells, what its springs measure, masses.
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "network.json")
            points.write(path)
            return _measurement(_core.measure_file(path, None, vectors, None, options))
    if springs is None or constants is None:
        raise failure("springs" if springs is None else "constants", "an array beside the points", "none")
    held = None if fix is None else places("fix", fix, total)
    masses = numbers("masses", masses)
    if masses is not None and (masses < 0).any():
        raise failure("masses", "masses from 0 kg", masses[masses < 0][0])
    network = {
        "points": matrix("points", points, np.float64),
        "springs": matrix("springs", springs, np.int64),
        "constants": numbers("constants", constants),
        "rest": numbers("rest", rest),
        "contents": _contents(contents),
        "masses": masses,
        "cell": vectors,
        "held": held,
    }
    if mesh is not None and not isinstance(mesh, Mesh):
        raise failure("mesh", "a Mesh", shown(mesh))
    return _measurement(_core.measure_arrays(network, None if mesh is None else mesh._core, options))

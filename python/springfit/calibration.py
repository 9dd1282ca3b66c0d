"""Moduli of a body from measurements, with intervals."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, Union

import numpy as np

from . import _core
from ._arguments import failure, matrix, measure, number, shown, word
from ._progress import listener
from .material import Material
from .mesh import Mesh
from .report import SceneLike, given, settings_of

Sigma = Union[float, str, Mapping[str, "float | str"], None]
#: What was measured under a load: displacements of all points of the mesh, or places and their displacements, or a dictionary of both and of
#: forces.
Measured = Union["np.ndarray", "tuple[Any, Any]", Mapping[str, Any]]

_UNKNOWNS = '"young", "moduli" or "cells"'
_PRIORS = '"edges" or "smooth"'
_KEYS = ("places", "displacements", "forces", "sigma")


@dataclass(frozen=True)
class Modulus:
    """A modulus that was found.

    Attributes:
        value: E, μ and λ in Pa; Poisson's ratio without a unit.
        interval: The true one is between these with 95 %; None where the measurements do not determine it, and where it was known.
        deviation: The standard deviation by noise: of the logarithm of E and μ, and of ν and λ themselves.
        mesh_deviation: That by the error of the meshes; None without a finer mesh.
    """

    value: float
    interval: "tuple[float, float] | None"
    deviation: float | None
    mesh_deviation: float | None

    def __float__(self) -> float:
        """The value, so that ``sf.Material(region.young, region.poisson)`` is the material that was found."""
        return float(self.value)

    @classmethod
    def _of(cls, record: "dict[str, Any]") -> "Modulus":
        ends = record["interval"]
        return cls(record["value"], None if ends is None else (ends[0], ends[1]), record["deviation"], record["mesh_deviation"])


@dataclass(frozen=True)
class Region:
    """The moduli of a region: Young's modulus, Poisson's ratio, the shear modulus μ and Lamé's λ."""

    name: str
    young: Modulus
    poisson: Modulus
    shear_modulus: Modulus
    lam: Modulus


@dataclass(frozen=True)
class Calibration:
    """What :func:`calibrate` has found.

    Attributes:
        regions: By name, the moduli of each region; empty with unknowns "cells".
        names: The unknowns, in the order of ``correlations``.
        correlations: Of the errors by noise, shape (unknowns, unknowns); NaN where they are not determined.
        young: Young's modulus of each cell, Pa, in the order of :attr:`Mesh.cells`; None with other unknowns.
        deviation: The standard deviation of each as a share of it, by noise with this prior, without the pull of the prior, which makes
            fields smoother than the body; None with other unknowns.
        misfit: How many times as large as the stated noise the residuals are; None without a stated noise.
        probability: Of residuals as large as these, or larger, if the model describes the body; None without a stated noise.
        is_unexplained: The residuals are more than noise: the model does not describe the body.
        is_trusted: Moduli and intervals are to be trusted: the search has reached its optimum, and residuals are at most three times the
            stated noise. The first of ``notes`` says why not.
        by_noise_alone: The intervals have no part for the error of the mesh.
        hardly_seen: Unknowns, or combinations of several, that the measurements hardly see.
        notes: Sentences for the reader.
        record: The whole report as a dictionary, as ``springfit calibrate --json`` prints it.
    """

    regions: "dict[str, Region]"
    names: "list[str]"
    correlations: np.ndarray
    young: "np.ndarray | None"
    deviation: "np.ndarray | None"
    misfit: float | None
    probability: float | None
    is_unexplained: bool
    is_trusted: bool
    by_noise_alone: bool
    hardly_seen: "list[str]"
    notes: "list[str]"
    record: "dict[str, Any]" = field(repr=False)

    @classmethod
    def _of(cls, record: "dict[str, Any]") -> "Calibration":
        def region(of: "dict[str, Any]") -> Region:
            moduli = (Modulus._of(of[key]) for key in ("young", "poisson", "shear_modulus", "lambda"))
            return Region(of["region"], *moduli)

        rows = [[np.nan if value is None else value for value in row] for row in record["correlations"]]
        cells = record["young_by_cell"]
        deviations = [np.nan if value is None else value for value in record["deviation_by_cell"]]
        return cls(
            regions={of["region"]: region(of) for of in record["regions"]},
            names=record["names"],
            correlations=np.array(rows, dtype=float).reshape(len(rows), len(rows)),
            young=np.array(cells) if cells else None,
            deviation=np.array(deviations) if cells else None,
            misfit=record["misfit"],
            probability=record["probability"],
            is_unexplained=record["is_unexplained"],
            is_trusted=record["is_trusted"],
            by_noise_alone=record["by_noise_alone"],
            hardly_seen=record["hardly_seen"],
            notes=record["notes"],
            record=record,
        )

    @property
    def table(self) -> Any:
        """A ``pandas.DataFrame`` with a row for each modulus of each region: ``region``, ``modulus``, ``value``, ``low``, ``high``,
        ``deviation`` and ``mesh_deviation``."""
        import pandas

        rows = []
        for name, region in self.regions.items():
            for key in ("young", "poisson", "shear_modulus", "lam"):
                modulus = getattr(region, key)
                low, high = modulus.interval or (None, None)
                rows.append((name, key, modulus.value, low, high, modulus.deviation, modulus.mesh_deviation))
        columns = ["region", "modulus", "value", "low", "high", "deviation", "mesh_deviation"]
        return pandas.DataFrame(rows, columns=columns)


def calibrate(
    mesh: "Mesh | SceneLike",
    regions: "Mapping[str, Material | Mapping[str, Any]] | Material | None" = None,
    measured: "Mapping[str, Measured] | None" = None,
    *,
    noise: Sigma = None,
    unknowns: Literal["young", "moduli", "cells"] | None = None,
    fix: "Sequence[Mapping[str, Any] | str] | Mapping[str, Any] | str" = (),
    loads: "Mapping[str, Mapping[str, Any]] | None" = None,
    law: str | None = None,
    known: "Sequence[str]" = (),
    prior: Literal["edges", "smooth"] | None = None,
    refinements: int | None = None,
    set: "Mapping[str, Any] | None" = None,
    folder: "str | os.PathLike[str] | None" = None,
    progress: "bool | Callable[[str, int, int], Any]" = False,
) -> Calibration:
    """Moduli of a body from measured displacements and forces, as ``springfit calibrate``.

    The finite elements of the mesh, and of refinements of it, move under the loads. The moduli are those with which their limit moves as
    measured, by least squares weighed with the noise; intervals have the noise and what is left of the error of the meshes.

    >>> import numpy as np, springfit as sf
    >>> mesh = sf.Mesh.box("hex8", [1, 1, 2], [2, 2, 4])
    >>> pull = {"pull": {"group": "zmax", "traction": [0, 0, 100]}}
    >>> seen = sf.Mesh.box("hex8", [1, 1, 2], [2, 2, 4]).points * [-0.003, -0.003, 0.01]
    >>> found = sf.calibrate(mesh, sf.Material(1e4, 0.3), {"pull": seen}, fix=[{"group": "zmin", "axes": ["z"]},
    ...     {"where": "x < 1e-6", "axes": ["x"]}, {"where": "y < 1e-6", "axes": ["y"]}], loads=pull, unknowns="moduli")
    >>> round(found.regions["body"].young.value), round(found.regions["body"].poisson.value, 3)
    (10000, 0.3)

    Args:
        mesh: The mesh; or a scene, its path or its keys, whose ``[[load]]`` have measurements and whose ``[calibrate]`` says the rest.
        regions: The first guess of the material of each region, by the group of its cells; one Material where the body is one region. A region
            ``"rest"`` has all other cells. Values are a Material or keys of ``[[material]]``.
        measured: By load, what was measured: displacements of all points of the mesh, shape (points, dimension); a pair of places in the body
            and their displacements, each of shape (places, dimension); or a dictionary with some of ``places``, ``displacements``, ``forces``
            (by group, the force that holds it, N) and ``sigma``. NaN was not measured. Places are those of the body at rest, anywhere in its
            cells.
        noise: The standard deviation of each displacement, a number of m or a text such as "0.1 mm": one for all loads, or by load; None if it is
            not known. That of forces is
            ``sigma_forces`` of the dictionary of the load.
        unknowns: Young's modulus of each region (the default), with Poisson's ratio ("moduli"), or Young's modulus of each cell ("cells").
        fix: What is held: a name of a group or keys of ``[[fix]]``, or a list of these.
        loads: By name, the keys of each ``[[load]]``, such as ``{"group": "top", "traction": [0, 0, -100]}``.
        law: A law of large deformation, such as "neo-hookean", of all regions; or each ``Material`` has it.
        known: Regions that keep their moduli.
        prior: With "cells", whether the field is constant but for jumps ("edges", the default) or smooth.
        refinements: How often the mesh is refined to know its error, 0 to 3; as often as takes seconds, at most twice, if None.
        set, folder: With a scene, keys that have another value, and where the files of a dictionary are.
        progress: True shows a bar; or a function of (stage, done, total).

    Returns:
        A :class:`Calibration`.

    Raises:
        SpringfitError: An array or a key is wrong, a place is outside of the body, or a load has no equilibrium.
    """
    keys: "dict[str, Any]" = {}
    if unknowns is not None:
        keys["unknowns"] = word("unknowns", unknowns, _UNKNOWNS)
    if prior is not None:
        keys["prior"] = word("prior", prior, _PRIORS)
    if refinements is not None:
        keys["refinements"] = int(number("refinements", refinements, "a number from 0 to 3"))
    if known:
        keys["known"] = list(known)
    if not isinstance(mesh, Mesh):
        if regions is not None or fix or loads is not None or law is not None:
            raise failure("mesh", "a Mesh, with regions, fix and loads", shown(mesh))
        settings = {**{f"calibrate.{key}": value for key, value in keys.items()}, **settings_of(set)}
        scene, base, _, held = given(mesh, folder)
        if held:
            raise failure("mesh", "a scene with files; calibrate(mesh, regions, …) takes what is in memory", "a mesh or an array in memory")
        with listener(progress) as told:
            found = _core.calibrate(scene, base, settings, None, *_readings(None, measured or {}, noise), told)
        return Calibration._of(json.loads(found))
    if set is not None or folder is not None:
        raise failure("set" if set is not None else "folder", "an argument for a scene alone", "it for a mesh")
    if not isinstance(loads, Mapping) or not loads:
        raise failure("loads", "a dictionary of loads by name", shown(loads))
    if not isinstance(measured, Mapping) or not measured:
        raise failure("measured", "a dictionary of measurements by load", shown(measured))
    for name in measured:
        if name not in loads:
            raise failure("measured", f"loads of {', '.join(loads)}", name)
    names = "xyz"[: mesh.dimension]
    box = {"element": {1: "line2", 2: "tri3", 3: "tet4"}[len(names)], "size": [1] * len(names), "cells": [1] * len(names)}
    scene = {
        "title": "calibration",
        # In place of the mesh that is given.
        "mesh": {"box": box},
        "material": _materials(regions, law),
        "fix": _fixes(fix),
        "load": [{"name": name, **own} for name, own in loads.items()],
        "calibrate": keys,
    }
    with listener(progress) as told:
        found = _core.calibrate(scene, given({}, None)[1], {}, mesh._core, *_readings(mesh, measured, noise), told)
    return Calibration._of(json.loads(found))


def _fixes(fix: Any) -> "list[dict[str, Any]]":
    """The ``[[fix]]`` of names of groups and of keys, or of one of them."""
    own = [fix] if isinstance(fix, (str, Mapping)) else list(fix)
    for one in own:
        if not isinstance(one, (str, Mapping)):
            raise failure("fix", "names of groups, or keys of [[fix]]", shown(one))
    return [{"group": one} if isinstance(one, str) else dict(one) for one in own]


def _materials(regions: Any, law: "str | None") -> Any:
    rest = {} if law is None else {"law": law}

    def keys(key: str, own: Any) -> "dict[str, Any]":
        if isinstance(own, Material):
            arrays: "dict[str, Any]" = {}
            found = own._entry(arrays)
            if arrays:
                raise failure(key, "numbers, texts or expressions, of which a factor is found", f"an array by cell for {', '.join(arrays)}")
        elif isinstance(own, Mapping):
            found = dict(own)
        else:
            raise failure(key, "a Material, or keys of [[material]]", shown(own))
        if law is not None and found.get("law", law) != law:
            raise failure("law", f"the law of the material, {found['law']}", law)
        return {**rest, **found}

    if isinstance(regions, Material):
        return keys("regions", regions)
    if not isinstance(regions, Mapping) or not regions:
        raise failure("regions", "a Material, or a dictionary of them by region", shown(regions))

    def entry(name: str, own: Any) -> "dict[str, Any]":
        found = {"name": name, **keys(f"regions.{name}", own)}
        is_placed = "group" in found or "where" in found or name == "rest"
        return found if is_placed else {"group": name, **found}

    return [entry(name, own) for name, own in regions.items()]


def _readings(mesh: "Mesh | None", measured: "Mapping[str, Measured]", noise: Sigma) -> "tuple[dict[str, Any], dict[str, Any]]":
    """Places and displacements by load, and forces by load."""
    displacements: "dict[str, Any]" = {}
    forces: "dict[str, Any]" = {}
    for load, own in measured.items():
        key = f"measured.{load}"
        sigma = noise.get(load) if isinstance(noise, Mapping) else noise
        sigma_forces = None
        held: "Mapping[str, Any]" = {}
        if isinstance(own, Mapping):
            for name in own:
                if name not in (*_KEYS, "sigma_forces"):
                    raise failure(key, f"some of {', '.join(_KEYS)} and sigma_forces", name)
            sigma, sigma_forces = own.get("sigma", sigma), own.get("sigma_forces")
            held, places, moved = own.get("forces", {}), own.get("places"), own.get("displacements")
        elif isinstance(own, tuple) and len(own) == 2:
            places, moved = own
        else:
            places, moved = None, own
        if moved is not None:
            if places is None:
                if mesh is None:
                    raise failure(key, "places and their displacements, with a scene", "displacements alone")
                places = mesh.points
            places = matrix(key, places, np.float64)
            moved = matrix(key, moved, np.float64)
            dimension = places.shape[1] if mesh is None else mesh.dimension
            if places.shape != moved.shape or places.shape[1] != dimension:
                expected = f"places and displacements of shape (places, {dimension})"
                raise failure(key, expected, f"{places.shape} and {moved.shape}")
            displacements[load] = (places, moved, None if sigma is None else measure(f"noise of {load}", sigma, "a number above zero, m, or a length"))
        noise_of_forces = None if sigma_forces is None else number(f"{key}.sigma_forces", sigma_forces, "a number above zero, N")
        if held:
            forces[load] = [(group, np.asarray(force, dtype=np.float64), noise_of_forces) for group, force in held.items()]
    return displacements, forces

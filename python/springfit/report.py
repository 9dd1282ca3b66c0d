"""Whole studies: a scene, and what came out of it."""

from __future__ import annotations

import json
import os
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from . import _core
from ._arguments import failure, shown
from ._lazy import Package
from ._progress import listener
from .material import Material, is_regions, regions
from .mesh import Mesh

if TYPE_CHECKING:
    import pandas

    from .network import Network
else:
    pandas, Network = Package("pandas"), Any

SceneLike = Union[str, "os.PathLike[str]", Mapping[str, Any]]

#: The name of the finite elements among the models of a load.
FINITE_ELEMENTS = ""


@dataclass
class Report:
    """The outcome of a scene.

    Attributes:
        record: The report as ``report.json`` has it.
        displacements: By load and by fit (the finite elements have the name ""), of those that reach the load, m, shape (points, dimension).
        files: What was written.

    Examples:
        >>> import springfit as sf
        >>> mesh = sf.Mesh.box("quad4", size=[2, 1], cells=[4, 2])
        >>> load = {"name": "pull", "group": "xmax", "traction": [10, 0]}
        >>> fix = {"group": "xmin"}
        >>> report = sf.run({"mesh": mesh, "material": sf.Material(1e4, 0.3), "fix": [fix], "load": [load], "fit": [{"objective": "exact"}]})
        >>> u = report.displacements["pull"]["exact"]
        >>> u.shape == report.points.shape
        True
        >>> report.networks["exact"]
        <springfit.Network exact: 15 points, 70 springs (38 between two points, 32 point-content)>
    """

    record: dict
    displacements: dict[str, dict[str, np.ndarray]] = field(repr=False)
    files: list[Path] = field(default_factory=list)
    _ran: Any = field(default=None, repr=False, compare=False)
    _mesh: Mesh | None = field(default=None, repr=False, compare=False)
    _networks: dict[str, Network] | None = field(default=None, repr=False, compare=False)

    @property
    def mesh(self) -> Mesh:
        """The mesh of the body, on whose points the displacements are.

        Raises:
            SpringfitError: The report is of a comparison, which has none.
        """
        if self._mesh is None:
            self._mesh = Mesh._of(self._found("mesh").mesh())
        return self._mesh

    @property
    def points(self) -> np.ndarray:
        """Coordinates of the points, m, shape (points, dimension)."""
        return self.mesh.points

    @property
    def networks(self) -> dict[str, Network]:
        """The network of each fit, by the name of the fit.

        Raises:
            SpringfitError: The report is of a comparison, which has none.
        """
        if self._networks is None:
            from .springs import Network

            ran, mesh = self._found("networks"), self.mesh
            self._networks = {name: Network._of(ran.network(i), mesh) for i, name in enumerate(ran.fits)}
        return self._networks

    def _found(self, key: str) -> Any:
        if self._ran is None:
            raise failure(key, "the report of sf.run", "one of a comparison")
        return self._ran

    def __getstate__(self) -> dict:
        # What is found once more is not kept twice.
        state = dict(self.__dict__)
        if self._ran is not None:
            state |= {"_ran": None, "_mesh": self.mesh, "_networks": self.networks}
        return state

    @property
    def notes(self) -> list[str]:
        """What a reader must know before the figures are trusted."""
        return list(self.record["notes"])

    @property
    def fits(self) -> pandas.DataFrame:
        """One row for each fit, a ``pandas.DataFrame``; what is a table itself is left out, and so are columns without a value."""
        plain = lambda value: not isinstance(value, (dict, list))
        return _frame([{k: v for k, v in fit.items() if plain(v)} for fit in self.record["fits"]])

    @property
    def loads(self) -> pandas.DataFrame:
        """One row for each fit and load, a ``pandas.DataFrame`` without columns that have no value."""
        rows = []
        for fit in self.record["fits"]:
            for load in fit["loads"]:
                plain = {k: v for k, v in load.items() if k != "name" and not isinstance(v, (dict, list))}
                rows.append({"fit": fit["name"], "load": load["name"], **plain})
        return _frame(rows)

    @property
    def frequencies(self) -> pandas.DataFrame:
        """One row for each model, a ``pandas.DataFrame``; empty where none were asked for."""
        return _frame(self.record["frequencies"])

    @property
    def motion(self) -> pandas.DataFrame:
        """One row for each model that moved, a ``pandas.DataFrame``; empty without a motion."""
        return _frame(self.record["motion"])

    def _repr_html_(self) -> str:
        rows = [("mesh", self.record.get("source", "")), ("fits", ", ".join(fit["name"] for fit in self.record["fits"]))]
        rows += [("loads", ", ".join(dict.fromkeys(load["name"] for fit in self.record["fits"] for load in fit["loads"])))]
        body = "".join(f"<tr><th style='text-align:left'>{escape(k)}</th><td>{escape(str(v))}</td></tr>" for k, v in rows if v)
        columns = ["fit", "load", "e_rms", "e_max"]
        errors = [{"fit": fit["name"], "load": load["name"], **load} for fit in self.record["fits"] for load in fit["loads"]]
        shown_errors = [[_cell(row.get(column)) if i > 1 else escape(str(row[column])) for i, column in enumerate(columns)] for row in errors]
        table = "".join(f"<tr>{''.join(f'<td>{cell}</td>' for cell in row)}</tr>" for row in shown_errors)
        head = "<tr><th>fit</th><th>load</th><th>%e_rms</th><th>%e_max</th></tr>" if table else ""
        notes = "".join(f"<li>{escape(note)}</li>" for note in self.notes)
        title = escape(str(self.record.get("scene", "")))
        return f"<table><caption>{title}</caption>{body}</table><table>{head}{table}</table><ul>{notes}</ul>"


def _cell(value: Any) -> str:
    return "" if value is None else f"{value:.3g}"


def _frame(rows: list[dict]) -> pandas.DataFrame:
    """A data frame without columns that have no value."""
    import pandas

    return pandas.DataFrame(rows).dropna(axis="columns", how="all")


def run(
    scene: SceneLike,
    *,
    set: Mapping[str, Any] | None = None,
    folder: str | os.PathLike[str] | None = None,
    out: str | os.PathLike[str] | None = None,
    progress: bool | Callable[[str, int, int], Any] = False,
) -> Report:
    """Fits, solves and compares a scene.

    Args:
        scene: The path of a scene file, or its keys as a dictionary.
        set: Keys that take the place of those of the scene, by their paths: ``{"material.poisson": 0.45, "fit[0].name": "a"}``.
        folder: Where the files that a dictionary names are; the current folder if None. The files of a scene file are relative to it.
        out: Where the outputs of the scene are written; nothing is written if None.
        progress: True shows a bar; or a function of (stage, done, total).

    Raises:
        SpringfitError: The scene or one of its files is wrong.

    Examples:
        >>> import springfit as sf
        >>> scene = {"mesh": sf.Mesh.box("tri3", size=[1, 1], cells=[2, 2]), "material": sf.Material(1e4, 0.3), "fit": [{"objective": "modal"}]}
        >>> sf.run(scene).fits["name"].tolist()
        ['modal 0.316']
    """
    scene, base, settings, held = given(scene, folder, set)
    with listener(progress) as told:
        text, displacements, files, ran = _core.run(scene, base, settings, held, None if out is None else Path(out), told)
    return Report(json.loads(text), displacements, [Path(path) for path in files], ran)


def given(
    scene: SceneLike, folder: str | os.PathLike[str] | None, set: Mapping[str, Any] | None = None
) -> tuple[dict | Path, Path, dict[str, Any], dict[str, Any]]:
    """A scene as the library takes it, the folder of the files that a dictionary names, keys with other values, and what is in memory by name."""
    held: dict[str, Any] = {}
    settings = plain(settings_of(set), held)
    path, base = _placed(scene, folder)
    if isinstance(path, dict):
        path = plain(path, held)
    return path, base, settings, _beside(held, path, settings)


def _beside(held: dict[str, Any], scene: Any, settings: dict[str, Any]) -> dict[str, Any]:
    """What is in memory, where arrays of cells know the mesh of the scene."""
    own = settings.get("mesh", scene.get("mesh") if isinstance(scene, dict) else None)
    mesh = held.get(own.get("file")) if isinstance(own, Mapping) else None
    return {name: (mesh, value[1]) if isinstance(value, tuple) else value for name, value in held.items()}


#: The most dictionaries and lists inside each other; the library refuses more.
DEEPEST = 64


def plain(value: Any, held: dict[str, Any], depth: int = 0) -> Any:
    """A value of a scene with names in place of the meshes and arrays in it, which are held by these names."""
    if isinstance(value, Mesh):
        name = f"memory:mesh-{value._core.checksum}-{_groups_sum(value):08x}"
        held[name] = value._core
        return {"file": name}
    if isinstance(value, Material):
        return value._entry(held)
    if is_regions(value):
        return regions(value, held)
    if depth > DEEPEST:
        return value
    if isinstance(value, Mapping):
        return {key: plain(own, held, depth + 1) for key, own in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(own, held, depth + 1) for own in value]
    return value


def _groups_sum(mesh: Mesh) -> int:
    """Tells the groups of a mesh from others."""
    total = 0
    for kind in (mesh.groups, mesh.cell_groups):
        for name, places in kind.items():
            total = zlib.crc32(places.tobytes(), zlib.crc32(name.encode(), total))
    return total


def _placed(scene: SceneLike, folder: str | os.PathLike[str] | None) -> tuple[dict | Path, Path]:
    if isinstance(scene, Mapping):
        return dict(scene), Path(folder or ".")
    if not isinstance(scene, (str, os.PathLike)):
        raise failure("scene", "the path of a scene file or a dictionary", shown(scene))
    if folder is not None:
        raise failure("folder", "a folder with a scene that is a dictionary alone", f"one with the file {os.fspath(scene)}")
    return Path(scene), Path(".")


def settings_of(given: Mapping[str, Any] | None) -> dict[str, Any]:
    """Values of keys by their paths."""
    if not isinstance(given, (Mapping, type(None))):
        raise failure("set", 'a dictionary such as {"material.poisson": 0.45}', shown(given))
    return dict(given or {})

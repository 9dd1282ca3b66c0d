"""Whole studies: a scene, and what came out of it."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from . import _core
from ._arguments import failure, shown
from ._progress import listener

if TYPE_CHECKING:
    import pandas

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
    """

    record: dict
    displacements: "dict[str, dict[str, np.ndarray]]" = field(repr=False)
    files: "list[Path]" = field(default_factory=list)

    @property
    def notes(self) -> "list[str]":
        """What a reader must know before the figures are trusted."""
        return self.record["notes"]

    @property
    def fits(self) -> "pandas.DataFrame":
        """One row for each fit, a ``pandas.DataFrame``; what is a table itself is left out."""
        import pandas

        plain = lambda value: not isinstance(value, (dict, list))
        return pandas.DataFrame([{k: v for k, v in fit.items() if plain(v)} for fit in self.record["fits"]])

    @property
    def loads(self) -> "pandas.DataFrame":
        """One row for each fit and load, a ``pandas.DataFrame``."""
        import pandas

        rows = []
        for fit in self.record["fits"]:
            for load in fit["loads"]:
                plain = {k: v for k, v in load.items() if k != "name" and not isinstance(v, (dict, list))}
                rows.append({"fit": fit["name"], "load": load["name"], **plain})
        return pandas.DataFrame(rows)

    @property
    def frequencies(self) -> "pandas.DataFrame":
        """One row for each model, a ``pandas.DataFrame``; empty where none were asked for."""
        import pandas

        return pandas.DataFrame(self.record["frequencies"])

    @property
    def motion(self) -> "pandas.DataFrame":
        """One row for each model that moved, a ``pandas.DataFrame``; empty without a motion."""
        import pandas

        return pandas.DataFrame(self.record["motion"])


def run(
    scene: SceneLike,
    *,
    set: "Mapping[str, Any] | None" = None,
    folder: "str | os.PathLike[str] | None" = None,
    out: "str | os.PathLike[str] | None" = None,
    progress: "bool | Callable[[str, int, int], Any]" = False,
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
    """
    scene, base = given(scene, folder)
    with listener(progress) as told:
        text, displacements, files = _core.run(scene, base, settings_of(set), None if out is None else Path(out), told)
    return Report(json.loads(text), displacements, [Path(path) for path in files])


def given(scene: "SceneLike", folder: "str | os.PathLike[str] | None") -> "tuple[dict | Path, Path]":
    """A scene as the library takes it, and the folder of the files that a dictionary names."""
    if isinstance(scene, Mapping):
        return dict(scene), Path(folder or ".")
    if not isinstance(scene, (str, os.PathLike)):
        raise failure("scene", "the path of a scene file or a dictionary", shown(scene))
    if folder is not None:
        raise failure("folder", "a folder with a scene that is a dictionary alone", f"one with the file {os.fspath(scene)}")
    return Path(scene), Path(".")


def settings_of(given: "Mapping[str, Any] | None") -> "dict[str, Any]":
    """Values of keys by their paths."""
    if not isinstance(given, (Mapping, type(None))):
        raise failure("set", 'a dictionary such as {"material.poisson": 0.45}', shown(given))
    return dict(given or {})

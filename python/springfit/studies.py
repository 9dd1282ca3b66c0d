"""Studies that compare objectives, refine meshes and try extreme cases."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Literal

from . import _core
from ._core import Element
from ._progress import listener
from .report import Report, given


def compare(
    what: "str | os.PathLike | Mapping[str, Any] | Element",
    *,
    set: "Mapping[str, Any] | None" = None,
    folder: "str | os.PathLike | None" = None,
    poisson: float = 0.3,
    plane: Literal["stress", "strain"] | None = None,
    shapes: int = 64,
    iterations: int = 1000,
    progress: "bool | Callable[[str, int, int], Any]" = False,
):
    """Objectives and solvers side by side, as ``springfit compare``.

    Args:
        what: A scene, whose body is fitted by many methods; or an ``Element``, of which random shapes are.
        set: Keys of the scene that have another value.
        folder: Where the files that a dictionary names are.
        poisson, plane, shapes, iterations: Of an element: Poisson's ratio, the state in the plane, how many shapes, and the most
            iterations of a solver.
        progress: True shows a bar; or a function of (stage, done, total).

    Returns:
        Of a scene a :class:`Report`; of an element a ``pandas.DataFrame`` with one row for each method.

    Raises:
        SpringfitError: The scene, a key or a number is wrong.
    """
    with listener(progress) as told:
        if isinstance(what, Element):
            import pandas

            rows = json.loads(_core.compare_element(what, float(poisson), plane, int(shapes), int(iterations), told))
            return pandas.json_normalize(rows)
        return Report(json.loads(_core.compare_scene((*given(what, folder), dict(set or {})), told)), {})


def converge(
    scene: "str | os.PathLike | Mapping[str, Any]",
    *,
    levels: int | None = None,
    truth: "str | os.PathLike | Mapping[str, Any] | None" = None,
    set: "Mapping[str, Any] | None" = None,
    folder: "str | os.PathLike | None" = None,
    progress: "bool | Callable[[str, int, int], Any]" = False,
) -> dict:
    """The errors of finite elements and networks on finer and finer meshes, as ``springfit converge``.

    Args:
        scene: The scene, whose mesh is the first.
        levels: How many meshes, from 2 to 8, each with cells of half the size; 4 if None, or fewer where they would take long.
        truth: A scene of the same body and loads whose finite elements are the reference.
        set: Keys of both that have another value.
        folder: Where the files that a dictionary names are.

    Returns:
        The document that ``springfit converge --json`` prints.

    Raises:
        SpringfitError: A scene or a number is wrong, or the finest mesh is too large.
    """
    settings = dict(set or {})
    reference = None if truth is None else (*given(truth, folder), settings)
    with listener(progress) as told:
        return json.loads(_core.converge((*given(scene, folder), settings), levels, reference, told))


def stability(
    what: "str | os.PathLike | Mapping[str, Any] | Element | None" = None,
    *,
    set: "Mapping[str, Any] | None" = None,
    folder: "str | os.PathLike | None" = None,
    progress: "bool | Callable[[str, int, int], Any]" = False,
):
    """Extreme cases: units, moduli and shapes far from usual ones, as ``springfit stability``.

    Args:
        what: A scene, an ``Element``, or None for all shipped elements.
        set: Keys of the scene that have another value.
        folder: Where the files that a dictionary names are.

    Returns:
        A ``pandas.DataFrame`` with one row for each case.

    Raises:
        SpringfitError: The scene or a key is wrong.
    """
    import pandas

    with listener(progress) as told:
        if what is None or isinstance(what, Element):
            found = json.loads(_core.stability(what, told))
        else:
            found = json.loads(_core.stability_of_scene((*given(what, folder), dict(set or {})), told))
    return pandas.json_normalize(found["rows"])

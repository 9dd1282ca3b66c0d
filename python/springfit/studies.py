"""Studies that compare objectives, refine meshes, take more shapes and try extreme cases."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np

from . import _core
from ._arguments import PLANES, count, failure, number, word
from ._core import Element
from ._functions import separated, warn_of_rest
from ._lazy import Package
from ._progress import listener
from .material import Material, MaterialLike, default_law
from .mesh import Mesh
from .network import check_body
from .report import Report, SceneLike, given

if TYPE_CHECKING:
    import pandas
else:
    pandas = Package("pandas")


@overload
def compare(
    what: Element,
    *,
    poisson: float | None = None,
    plane: Literal["stress", "strain"] | None = None,
    shapes: int | None = None,
    iterations: int | None = None,
    progress: bool | Callable[[str, int, int], Any] = False,
) -> pandas.DataFrame: ...
@overload
def compare(
    what: SceneLike,
    *,
    set: Mapping[str, Any] | None = None,
    folder: str | os.PathLike[str] | None = None,
    progress: bool | Callable[[str, int, int], Any] = False,
) -> Report: ...
def compare(
    what: SceneLike | Element,
    *,
    set: Mapping[str, Any] | None = None,
    folder: str | os.PathLike[str] | None = None,
    poisson: float | None = None,
    plane: Literal["stress", "strain"] | None = None,
    shapes: int | None = None,
    iterations: int | None = None,
    progress: bool | Callable[[str, int, int], Any] = False,
) -> Report | pandas.DataFrame:
    """Fits side by side, as ``springfit compare``.

    Args:
        what: A scene, whose body is fitted by many methods; an ``Element``, of which random shapes are; or a comparison: the path of a file
            with a table ``[compare]``, or its keys as a dictionary.
        set: Keys of the scene that have another value.
        folder: Where the files that a dictionary names are.
        poisson, plane, shapes, iterations: With an element alone: Poisson's ratio (0.3 if None), the state in the plane, how many shapes
            (64), and the most iterations of a solver (1000).
        progress: True shows a bar; or a function of (stage, done, total).

    Returns:
        Of a scene a :class:`Report`; of an element a ``pandas.DataFrame`` with one row for each method, whose times are processor times of
        one thread for each element that is fitted, s. Of a comparison a ``pandas.DataFrame`` in long form, with a row for each value: the
        columns of its case and of its fit, ``item``, ``quantity`` and ``value``.

    Raises:
        SpringfitError: The scene, a key or a number is wrong, or an argument is not of what is compared.

    Examples:
        >>> import springfit as sf
        >>> table = sf.compare(sf.Element("tri3"), shapes=4)
        >>> "frobenius" in str(table.iloc[:, 0].tolist())
        True
    """
    if _is_comparison(what):
        _refuse("a scene or an element", "a comparison", set=set, poisson=poisson, plane=plane, shapes=shapes, iterations=iterations)
        import pandas

        with listener(progress) as told:
            comparison, base, _, _ = given(what, folder)
            columns = json.loads(_core.compare_cases(comparison, base, told))
        return pandas.DataFrame(dict(columns))
    if isinstance(what, Element):
        _refuse("a scene", "an element", set=set, folder=folder)
    else:
        _refuse("an element", "a scene", poisson=poisson, plane=plane, shapes=shapes, iterations=iterations)
    with listener(progress) as told:
        if isinstance(what, Element):
            import pandas

            nu = number("poisson", 0.3 if poisson is None else poisson, "a number above -1 and below 0.5")
            state = word("plane", plane, PLANES)
            counts = (count("shapes", 64 if shapes is None else shapes), count("iterations", 1000 if iterations is None else iterations))
            return pandas.json_normalize(json.loads(_core.compare_element(what, nu, state, *counts, told)))
        return Report(json.loads(_core.compare_scene(given(what, folder, set), told)), {})


def _is_comparison(what: Any) -> bool:
    if isinstance(what, Mapping):
        return "compare" in what
    if isinstance(what, (str, os.PathLike)):
        try:
            return _core.is_comparison(Path(what).read_text())
        except (OSError, UnicodeDecodeError):
            return False
    return False


def converge(
    scene: SceneLike,
    *,
    levels: int | None = None,
    truth: SceneLike | None = None,
    set: Mapping[str, Any] | None = None,
    folder: str | os.PathLike[str] | None = None,
    progress: bool | Callable[[str, int, int], Any] = False,
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

    Examples:
        >>> import springfit as sf
        >>> load = {"name": "pull", "group": "xmax", "traction": [10, 0]}
        >>> body = {"mesh": sf.Mesh.box("quad4", size=[2, 1], cells=[2, 1]), "material": sf.Material(1e4, 0.3)}
        >>> found = sf.converge({**body, "fix": [{"group": "xmin"}], "load": [load], "fit": [{"objective": "exact"}]}, levels=2)
        >>> len(found["levels"])
        2
    """
    # The folder is that of the dictionaries among both scenes.
    folders = [folder if isinstance(own, Mapping) else None for own in (scene, truth)]
    if folders == [None, None]:
        folders[0] = folder
    reference = None if truth is None else given(truth, folders[1], set)
    levels = None if levels is None else count("levels", levels)
    with listener(progress) as told:
        return json.loads(_core.converge(given(scene, folders[0], set), levels, reference, told))


def stability(
    what: SceneLike | Element | None = None,
    *,
    set: Mapping[str, Any] | None = None,
    folder: str | os.PathLike[str] | None = None,
    progress: bool | Callable[[str, int, int], Any] = False,
) -> pandas.DataFrame:
    """Extreme cases: units, moduli and shapes far from usual ones, as ``springfit stability``.

    Args:
        what: A scene, an ``Element``, or None for all shipped elements.
        set: Keys of the scene that have another value.
        folder: Where the files that a dictionary names are.

    Returns:
        A ``pandas.DataFrame`` with one row for each case.

    Raises:
        SpringfitError: The scene or a key is wrong, or keys are given without a scene.

    Examples:
        >>> import springfit as sf
        >>> len(sf.stability(sf.Element("tri3"))) > 10
        True
    """
    import pandas

    if what is None or isinstance(what, Element):
        _refuse("a scene", "an element", set=set, folder=folder)
    with listener(progress) as told:
        if what is None or isinstance(what, Element):
            found = json.loads(_core.stability(what, told))
        else:
            found = json.loads(_core.stability_of_scene(given(what, folder, set), told))
    return pandas.json_normalize(found["rows"])


def learning_curve(
    mesh: Mesh,
    material: MaterialLike,
    law: str | os.PathLike[str] | Callable[[np.ndarray], Any] | None = None,
    *,
    counts: list[int],
    seeds: list[int] | None = None,
    progress: bool | Callable[[str, int, int], Any] = False,
    **keys: Any,
) -> pandas.DataFrame:
    """The errors of a sampled fit over the number of its shapes.

    Each fit sees the first shapes of one sequence for each seed, so that a larger one sees those of a smaller one as well, and all have the same
    shapes held out: those of the fit's own seed.

    Args:
        counts: Numbers of shapes, of each set.
        seeds: Seeds of the sequences; that of the shapes if None.
        **keys: What :func:`sampled` takes.

    Returns:
        A ``pandas.DataFrame`` with a row for each seed and count: ``seed``, ``shapes``, ``seconds`` (without the shapes that are held out),
        ``trained`` and ``held_out`` (the mean relative errors over the cells), ``trained_max`` and ``held_out_max``, and ``held_out NAME`` for
        each family.

    Raises:
        SpringfitError: As by :func:`sampled`; or a count or a seed is wrong, or no shape is held out.

    Examples:
        >>> import springfit as sf
        >>> mesh = sf.Mesh.box("tri3", size=[1, 1], cells=[1, 1])
        >>> curve = sf.learning_curve(mesh, sf.Material(1e4, 0.3), "neo-hookean", springs=["edge"], counts=[5, 10], shapes={"held_out": 10})
        >>> curve["shapes"].tolist()
        [5, 10]
    """
    import pandas

    check_body(mesh, material)
    counts = [count("counts", one) for one in counts]
    shapes = keys.get("shapes")
    if isinstance(shapes, Mapping):
        if "sampler" in shapes:
            keys["shapes"] = shapes = {**shapes, "count": max(counts, default=1)}
        seeds = [shapes.get("seed") or 1] if seeds is None else seeds
    if law is None and isinstance(material, Material) and keys.get("stress") is None:
        law = default_law(material)
    law = law if law is None or callable(law) else os.fspath(law)
    entry, functions = separated({"objective": "sampled", "springs": keys.pop("springs", None), "law": law, **keys})
    if functions is not None and functions["energy"] is not None:
        warn_of_rest(material, *functions["energy"][1:])
    with listener(progress) as told:
        text = _core.learning_curve(mesh._core, material, entry, counts, [1] if seeds is None else list(seeds), told, functions)
    rows = []
    for point in json.loads(text):
        row = {key: point[key] for key in ("seed", "shapes", "seconds")}
        for key in ("trained", "held_out"):
            row |= {key: point[key]["mean"], f"{key}_max": point[key]["max"]}
        rows.append(row | {f"held_out {family['family']}": family["held_out"]["mean"] for family in point["families"]})
    return pandas.DataFrame(rows)


def _refuse(owner: str, what: str, **arguments: Any) -> None:
    """Raises if one of these arguments is given, which another kind of study has."""
    for key, value in arguments.items():
        if value is not None:
            raise failure(key, f"an argument for {owner} alone", f"it for {what}")

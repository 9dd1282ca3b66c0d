"""Many studies of one scene."""

from __future__ import annotations

import json
import os
import queue
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from . import _core
from ._arguments import failure
from ._core import SpringfitError
from ._lazy import Package
from ._progress import listener
from .report import SceneLike, given, plain

if TYPE_CHECKING:
    import pandas
else:
    pandas = Package("pandas")


def sweep(
    scene: SceneLike,
    over: Mapping[str, Any] | Iterable[Mapping[str, Any]] | None = None,
    *,
    design: Literal["grid", "random", "sobol"] | None = None,
    samples: int | None = None,
    seed: int | None = None,
    set: Mapping[str, Any] | None = None,
    executor: Any = None,
    folder: str | os.PathLike[str] | None = None,
    records: str | os.PathLike[str] | None = None,
    progress: bool | Callable[[str, int, int], Any] = False,
) -> pandas.DataFrame:
    """Runs a scene for many values of its keys. The command ``springfit sweep`` gives the same rows.

    Args:
        scene: The path of a scene file, or its keys as a dictionary.
        over: By the path of a key, its values: a list, or a range as a dictionary such as ``{"from": 0.1, "to": 0.4, "count": 4}``. Or a
            list of dictionaries, each a study. None takes all of ``[sweep]`` of the scene.
        design: "grid" (the default) makes a study of every combination, the last key running fastest; "random" and "sobol" sample
            ranges and lists.
        samples: The number of studies of a random or Sobol design.
        seed: Another one gives other samples. A Sobol design without a seed starts at the lower ends of the ranges.
        set: Keys that have another value than in the scene, in all studies.
        executor: Who runs the studies: an executor of ``concurrent.futures`` or a Dask client (what has ``submit``), the module ``ray``,
            or a ``multiprocessing.Pool`` (what has ``imap_unordered``). None runs one study after the other.
        folder: Where the files that a dictionary names are.
        records: A file of one JSON line for each study, as the command writes it. Studies that it has are not run again, so that a sweep
            goes on after it was killed. It can be read at any time.
        progress: True shows a bar; or a function of (stage, done, total).

    Returns:
        A ``pandas.DataFrame`` with one row for each study, fit and load: the number of the study from 1, its values, and the figures. A
        study that failed is one row with its ``error``, which is None of others. The rows are in the order of the studies, whatever finished first.

    Raises:
        SpringfitError: The scene, its sweep or the records are wrong, or the executor takes no work.

    Examples:
        >>> import springfit as sf
        >>> load = {"name": "pull", "group": "xmax", "traction": [10, 0]}
        >>> body = {"mesh": sf.Mesh.box("quad4", size=[2, 1], cells=[2, 1]), "material": sf.Material(1e4, 0.3)}
        >>> scene = {**body, "fix": [{"group": "xmin"}], "load": [load], "fit": [{"objective": "exact"}]}
        >>> table = sf.sweep(scene, {"material.poisson": [0.1, 0.4]})
        >>> table["material.poisson"].tolist(), table["error"].tolist()
        ([0.1, 0.4], [None, None])
    """
    import pandas

    scene, base, settings, held = given(scene, folder, set)
    plan = None
    if over is not None:
        over = _plain(plain(dict(over) if isinstance(over, Mapping) else list(over), held))
        plan = {"over": over, "design": design, "samples": samples, "seed": seed}
    elif not (design is None and samples is None and seed is None):
        settings |= {f"sweep.{k}": v for k, v in {"design": design, "samples": samples, "seed": seed}.items() if v is not None}
    core = _core.Sweep(scene, base.resolve(), settings, held, plan)
    settings = {key: value for key, value in settings.items() if not key.startswith("sweep.")}
    with tempfile.TemporaryDirectory() as scratch, listener(progress) as told:
        lines = _core.Studies(Path(records or Path(scratch, "studies.jsonl")), core)
        text, path = core.scene
        marks = list(dict.fromkeys(core.marks))
        waiting = [(text, Path(path).resolve(), settings, mark, held) for mark in marks if mark not in lines]
        done = len(marks) - len(waiting)
        for line in _results(executor, waiting):
            lines.push(line)
            done += 1
            if told is not None:
                told("studies", done, len(marks))
        columns, rows = core.table(lines)
        del lines
    table = pandas.DataFrame(json.loads(rows), columns=columns)
    if "error" not in table:
        table["error"] = None
    return table


def _plain(value: Any) -> Any:
    """Without the types of NumPy and iterators, which have no place in TOML."""
    if isinstance(value, Mapping):
        return {key: _plain(entry) for key, entry in value.items()}
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Iterable) and not isinstance(value, (str, bytes)):
        return [_plain(entry) for entry in value]
    return value


def _study(task: tuple[str, Path, dict, str, dict]) -> str:
    """The line of one study; runs in the threads and processes of an executor."""
    return _core.study_line(*task)


def _results(executor: Any, tasks: list) -> Iterator[str]:
    """The lines of the studies as they become ready."""
    if executor is None:
        yield from map(_study, tasks)
    elif hasattr(executor, "submit"):
        yield from _submitted(executor, tasks)
    elif hasattr(executor, "imap_unordered"):
        yield from executor.imap_unordered(_study, tasks)
    elif hasattr(executor, "remote") and hasattr(executor, "wait"):
        study = executor.remote(_study)
        left = [study.remote(task) for task in tasks]
        while left:
            ready, left = executor.wait(left, num_returns=1)
            yield from executor.get(ready)
    else:
        expected = "an executor with submit, a pool with imap_unordered, or the module ray"
        raise failure("executor", expected, type(executor).__name__)


def _submitted(executor: Any, tasks: list) -> Iterator[str]:
    ready: queue.SimpleQueue = queue.SimpleQueue()
    futures = []
    try:
        for task in tasks:
            future = executor.submit(_study, task)
            futures.append(future)
            future.add_done_callback(ready.put)
        for _ in tasks:
            yield ready.get().result()
    except SpringfitError:
        raise
    except Exception as error:  # of the executor: it is closed, or one of its processes has ended
        raise failure("executor", "one that takes work and brings it to its end", f"{type(error).__name__}: {error}") from error
    finally:
        for future in futures:
            future.cancel()

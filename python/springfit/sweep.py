"""Many studies of one scene."""

from __future__ import annotations

import itertools
import json
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from .mesh import failure
from .report import _read, run


def sweep(
    scene: "str | os.PathLike | Mapping[str, Any]",
    over: "Mapping[str, Iterable] | Iterable[Mapping[str, Any]]",
    *,
    executor: Any = None,
    folder: "str | os.PathLike | None" = None,
    records: "str | os.PathLike | None" = None,
):
    """Runs a scene for every combination of some keys' values.

    Args:
        scene: The path of a scene file, or its keys as a dictionary.
        over: By the path of a key, its values: every combination is a study, the last key running fastest. Or a list of dictionaries,
            each a study.
        executor: What has ``submit(function, *arguments)`` that returns a future: ``concurrent.futures`` executors, Dask clients. A
            function ``executor.remote`` is not required. None runs one study after the other.
        folder: Where the files that a dictionary names are.
        records: A file of one JSON line for each study. Studies that it has are not run again, so that a sweep which was killed goes on.

    Returns:
        A ``pandas.DataFrame`` with one row for each study, fit and load: the keys of the study, and the figures. A study that failed is
        one row with its ``error``. The rows are in the order of the studies, whatever finished first.
    """
    import pandas

    studies = list(_studies(over))
    keys, base = (dict(scene), Path(folder or ".")) if isinstance(scene, Mapping) else _read(scene)
    base = base.resolve()
    done = _known(records)
    marks = [json.dumps(study, sort_keys=True, default=_plain) for study in studies]
    waiting = [i for i, mark in enumerate(marks) if mark not in done]
    for mark, rows in _results(executor, keys, base, [(marks[i], studies[i]) for i in waiting]):
        done[mark] = rows
        if records is not None:
            with open(records, "a", encoding="utf-8") as file:
                file.write(json.dumps({"study": json.loads(mark), "rows": rows}) + "\n")
    rows = [{**json.loads(mark), **row} for mark in marks for row in done[mark]]
    return pandas.DataFrame(rows)


def _studies(over):
    if isinstance(over, Mapping):
        lists = [list(values) for values in over.values()]
        for values in itertools.product(*lists):
            yield dict(zip(over, values))
        return
    for study in over:
        if not isinstance(study, Mapping):
            raise failure("over", "dictionaries of keys", type(study).__name__)
        yield dict(study)


def _plain(value: Any) -> Any:
    return value.tolist() if hasattr(value, "tolist") else os.fspath(value)


def _known(records) -> dict:
    """The rows of each study that a file has. A last line that was cut short is left out, and cut off."""
    if records is None or not os.path.exists(records):
        return {}
    known, whole = {}, 0
    with open(records, "rb") as file:
        for number, line in enumerate(file, 1):
            if not line.endswith(b"\n"):
                break
            try:
                entry = json.loads(line)
                known[json.dumps(entry["study"], sort_keys=True)] = entry["rows"]
            except (ValueError, KeyError, TypeError):
                raise failure("records", f"JSON lines of an earlier sweep in {records}", f"line {number}") from None
            whole += len(line)
    os.truncate(records, whole)
    return known


def _results(executor, keys, base, studies):
    """Marks and rows, as they become ready."""
    if executor is None:
        for mark, study in studies:
            yield mark, _study(keys, base, study)
        return
    from concurrent.futures import FIRST_COMPLETED, Future, wait

    futures = {}
    for mark, study in studies:
        futures[executor.submit(_study, keys, base, study)] = mark
    if all(isinstance(future, Future) for future in futures):
        left = set(futures)
        while left:
            ready, left = wait(left, return_when=FIRST_COMPLETED)
            for future in ready:
                yield futures[future], future.result()
        return
    for future, mark in futures.items():
        yield mark, future.result()


def _study(keys: dict, base: Path, study: dict) -> "list[dict]":
    """The rows of one study."""
    try:
        report = run(keys, set=study, folder=base)
    except ValueError as error:
        return [{"error": str(error)}]
    rows = []
    plain = lambda entry: {k: v for k, v in entry.items() if not isinstance(v, (dict, list))}
    for fit in report.record["fits"]:
        own = plain(fit)
        own["fit"] = own.pop("name")
        loads = [{"load": load["name"], **{k: v for k, v in plain(load).items() if k != "name"}} for load in fit["loads"]]
        rows += [{**own, **load} for load in loads] or [own]
    return rows

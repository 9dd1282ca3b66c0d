"""Springs on areas, volumes, angles and other measures, as the compiled part takes them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ._arguments import array, failure, matrix, shown, typed

#: The keys of a group of springs; those that are not here are refused.
KEYS = ("kind", "points", "constants", "rest", "law", "parameters", "element", "weights", "gradients", "cells", "expression", "unit")


def given_groups(contents: Any) -> "list[dict[str, Any]]":
    """The groups of ``contents`` with all keys."""
    return [_group(f"contents[{i}]", group) for i, group in enumerate(_list(contents))]


def changed_groups(contents: Any) -> "list[dict[str, Any]]":
    """New numbers of each group: an array of constants, or a dictionary of ``constants``, ``rest`` and ``parameters``."""
    changed = []
    for i, group in enumerate(_list(contents)):
        key = f"contents[{i}]"
        group = {} if group is None else group if isinstance(group, Mapping) else {"constants": group}
        _check_keys(key, group)
        changed.append({
            "constants": numbers(f"{key}.constants", group.get("constants")),
            "rest": numbers(f"{key}.rest", group.get("rest")),
            "parameters": _parameters(key, group),
        })
    return changed


def numbers(key: str, values: Any) -> "np.ndarray | None":
    """A list of real numbers, or None."""
    if values is None:
        return None
    found = array(key, values)
    if found.ndim != 1:
        raise failure(key, "an array of one dimension", f"one of shape {found.shape}")
    return typed(key, found.astype(np.float64) if found.size == 0 else found, np.float64)


def places_of_points(key: str, values: Any) -> np.ndarray:
    """The points of each spring."""
    found = array(key, values)
    # The type of an empty list says nothing.
    return matrix(key, found.astype(np.int64) if found.size == 0 else found, np.int64)


def _list(contents: Any) -> "Sequence[Any]":
    if contents is None:
        return ()
    if isinstance(contents, (str, Mapping, np.ndarray)) or not isinstance(contents, Sequence):
        raise failure("contents", "a list of dictionaries, as Network.contents", shown(contents))
    return contents


def _check_keys(key: str, group: Mapping) -> None:
    wrong = [name for name in group if name not in KEYS]
    if wrong:
        raise failure(f"{key}.{wrong[0]}", "one of " + ", ".join(KEYS), f'"{wrong[0]}"')


def _group(key: str, group: Any) -> "dict[str, Any]":
    if not isinstance(group, Mapping):
        raise failure(key, "a dictionary of kind, points, constants and rest", shown(group))
    _check_keys(key, group)
    for name in ("kind", "points", "constants"):
        if group.get(name) is None:
            raise failure(f"{key}.{name}", "the key", "none")
    for name in ("kind", "law", "element", "expression"):
        if not isinstance(group.get(name, ""), (str, type(None))):
            raise failure(f"{key}.{name}", "a text", shown(group[name]))
    gradients = group.get("gradients")
    cells = group.get("cells")
    if cells is not None:
        try:
            cells = [[([int(a) for a in nodes], float(share)) for nodes, share in of] for of in cells]
        except (TypeError, ValueError) as error:
            raise failure(f"{key}.cells", "lists of (nodes, share)", str(error)) from error
        if any(a < 0 for of in cells for nodes, _ in of for a in nodes):
            raise failure(f"{key}.cells", "places of nodes from 0", "one below")
    return {
        "kind": group["kind"],
        "points": places_of_points(f"{key}.points", group["points"]),
        "constants": numbers(f"{key}.constants", group["constants"]),
        "rest": numbers(f"{key}.rest", group.get("rest")),
        "law": group.get("law"),
        "parameters": _parameters(key, group),
        "element": group.get("element"),
        "weights": numbers(f"{key}.weights", group.get("weights")),
        "gradients": None if gradients is None else matrix(f"{key}.gradients", gradients, np.float64),
        "cells": cells,
        "expression": group.get("expression"),
    }


def _parameters(key: str, group: Mapping) -> "dict[str, np.ndarray]":
    given = group.get("parameters")
    if given is None:
        return {}
    if not isinstance(given, Mapping):
        raise failure(f"{key}.parameters", "a dictionary of arrays by name", shown(given))
    return {str(name): numbers(f"{key}.parameters.{name}", values) for name, values in given.items()}  # type: ignore[misc]

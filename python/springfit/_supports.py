"""What holds a network and what acts on it, as arrays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ._arguments import array, failure, no_flags, shown, typed, warn

if TYPE_CHECKING:
    from .springs import Network

#: How many points an error names.
NAMED = 8


def group_points(key: str, groups: "dict[str, np.ndarray] | None", name: Any) -> np.ndarray:
    """The points of a group; ``groups`` is None of networks without a mesh."""
    if groups is None:
        expected = "places of points or flags, as the network has no mesh, whose groups have names"
        raise failure(key, expected, shown(name))
    if not isinstance(name, str) or name not in groups:
        known = "a group of the mesh: " + ", ".join(groups) if groups else "places of points or flags, as the mesh has no groups"
        raise failure(key, known, shown(name))
    return groups[name]


def held_flags(shape: "tuple[int, ...]", groups: "dict[str, np.ndarray] | None", fix: Any) -> np.ndarray:
    """Which components ``fix`` holds, (points, dimension)."""
    held = np.zeros(shape, dtype=bool)
    if fix is None:
        raise failure("fix", "what is held", "nothing")
    if isinstance(fix, str):
        fix = [fix]
    if isinstance(fix, (list, tuple)) and len(fix) > 0 and all(isinstance(name, str) for name in fix):
        for name in fix:
            held[group_points("fix", groups, name)] = True
        return held
    fix = array("fix", fix)
    if fix.dtype == bool and fix.shape in (shape, shape[:1]):
        held[fix] = True
    elif fix.ndim == 1 and (fix.size == 0 or fix.dtype.kind in "iu"):
        no_flags("fix", fix, shape[0])
        outside = fix[(fix < 0) | (fix >= shape[0])] if fix.size else fix
        if outside.size:
            raise failure("fix", f"places of points from 0 and below {shape[0]}", outside[0])
        held[fix.astype(np.int64)] = True
    else:
        expected = f"names of groups, places of points below {shape[0]}, or flags of shape {shape[:1]} or {shape}"
        raise failure("fix", expected, f"values of type {fix.dtype}, shape {fix.shape}")
    return held


def forces_of(net: "Network", forces: Any) -> np.ndarray:
    """Forces on the points, N, (points, dimension) or of several loads, (loads, points, dimension). Those of a dictionary are totals of groups."""
    shape = net.points.shape
    if forces is None:
        return np.zeros(shape)
    if not isinstance(forces, Mapping):
        return vectors("forces", forces, shape)
    total, groups = np.zeros(shape), net._groups
    for name, force in forces.items():
        group_points("forces", groups, name)
        total += net._core.group_forces(name, _vector(f"forces.{name}", force, shape[1]).tolist())
    return total


def displacement_of(net: "Network", displacement: Any, held: np.ndarray) -> np.ndarray:
    """Displacements of what is held, m, zero elsewhere, as :func:`forces_of`; those of a dictionary are of all points of a group."""
    shape = net.points.shape
    if displacement is None:
        return np.zeros(shape)
    if isinstance(displacement, Mapping):
        found, groups = np.zeros(shape), net._groups
        seen: dict[int, str] = {}
        for name, moved in displacement.items():
            points, moved = group_points("displacement", groups, name), _vector(f"displacement.{name}", moved, shape[1])
            twice = [p for p in points.tolist() if p in seen and (found[p] != moved).any()]
            if twice:
                expected = f"one displacement of each point, or flags and an array of shape {shape}"
                raise failure(f"displacement.{name}", expected, f"another one of point {twice[0]} in displacement.{seen[twice[0]]}")
            found[points] = moved
            seen.update(dict.fromkeys(points.tolist(), name))
    else:
        found = vectors("displacement", displacement, shape)
    check_held(found, held)
    return found


def check_held(found: np.ndarray, held: np.ndarray) -> None:
    """Raises where displacements, (…, points, dimension), are given of what is not held."""
    is_loose = (found != 0) & ~held
    loose = np.flatnonzero(is_loose.any(axis=-1).reshape(-1, held.shape[0]).any(axis=0))
    if loose.size:
        named = ", ".join(map(str, loose[:NAMED])) + (", …" if loose.size > NAMED else "")
        raise failure("displacement", "zero wherever fix does not hold", f"others at {loose.size} points: {named}")


def check_acting(forces: np.ndarray, displacement: np.ndarray, held: np.ndarray) -> None:
    """Warns of loads, (loads, points, dimension), all of whose forces act on what is held: supports bear them, and they move nothing."""
    is_borne = (forces != 0).any(axis=(1, 2)) & ~((forces != 0) & ~held).any(axis=(1, 2)) & ~(displacement != 0).any(axis=(1, 2))
    if is_borne.any():
        load = f" of load {np.flatnonzero(is_borne)[0]}" if len(forces) > 1 else ""
        warn(f"all forces{load} act on what is held, and move nothing")


def vectors(key: str, values: Any, shape: "tuple[int, ...]") -> np.ndarray:
    """A vector for each point, (points, dimension), or several of these, (…, points, dimension)."""
    found = array(key, values)
    if found.ndim < 2 or found.shape[-2:] != shape:
        raise failure(key, f"an array of shape {shape} or (…, {shape[0]}, {shape[1]})", f"one of shape {found.shape}")
    return typed(key, found, np.float64)


def one_of_each(key: str, values: Any, shape: "tuple[int, ...]") -> np.ndarray:
    """A vector for each point, (points, dimension)."""
    found = array(key, values)
    if found.shape != shape:
        raise failure(key, f"an array of shape {shape}", f"one of shape {found.shape}")
    return typed(key, found, np.float64)


def _vector(key: str, values: Any, d: int) -> np.ndarray:
    found = array(key, values)
    if found.shape != (d,):
        raise failure(key, f"{d} numbers", f"values of shape {found.shape}")
    return typed(key, found, np.float64)

"""The motion of a network in time."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ._arguments import array, count, failure, number, shown, typed, warn
from ._contents import numbers
from ._supports import displacement_of, forces_of, one_of_each

if TYPE_CHECKING:
    from .network import Network

_METHODS = ("implicit-euler", "bdf2", "newmark", "symplectic-euler")


class Motion(NamedTuple):
    """The states of a motion that were kept.

    Attributes:
        times: s, shape (states,).
        positions: m, shape (states, points, dimension).
        velocities: m/s, shape (states, points, dimension).
    """

    times: np.ndarray
    positions: np.ndarray
    velocities: np.ndarray


def simulate(
    net: "Network",
    held: np.ndarray,
    forces: Any,
    displacement: Any,
    *,
    dt: float,
    steps: int,
    x0: Any,
    v0: Any,
    method: str,
    damping: Any,
    gravity: Any,
    masses: Any,
    every: int,
    callback: "Callable[[float, np.ndarray, np.ndarray], Any] | None",
) -> "Motion | None":
    """See :meth:`Network.simulate`."""
    shape = net.points.shape
    if method not in _METHODS:
        raise failure("method", "one of " + ", ".join(_METHODS), shown(method))
    if callback is not None and not callable(callback):
        raise failure("callback", "a function of time, positions and velocities", shown(callback))
    acting = forces_of(net, forces)
    moved = displacement_of(net, displacement, held)
    for key, given in (("forces", acting), ("displacement", moved)):
        if given.shape != shape:
            raise failure(key, f"an array of shape {shape}", f"one of shape {given.shape}")
    step = number("dt", dt, "a time above zero, s")
    if not 0.0 < step < float("inf"):
        raise failure("dt", "a time above zero, s", step)
    rayleigh, ratio = _damping(damping)
    pull = [] if gravity is None else typed("gravity", array("gravity", gravity), np.float64)
    if gravity is not None and np.shape(pull) != shape[1:]:
        raise failure("gravity", f"{shape[1]} numbers, m/s²", f"values of shape {np.shape(pull)}")
    keys = {
        "held": held,
        "forces": acting,
        "prescribed": moved,
        "start": net.points + moved if x0 is None else one_of_each("x0", x0, shape),
        "velocity": np.zeros(shape) if v0 is None else one_of_each("v0", v0, shape),
        "masses": numbers("masses", masses),
        "gravity": list(map(float, pull)),
        "step": step,
        "steps": count("steps", steps),
        "every": count("every", every),
        "method": method,
        "rayleigh": rayleigh,
        "ratio": ratio,
        "callback": callback,
    }
    times, positions, velocities, unsolved = net._core.simulate(keys)
    if unsolved:
        warn(f"the equations of {unsolved} of {steps} steps were not solved to the tolerance: a shorter step is more accurate")
    return None if callback is not None else Motion(times, positions, velocities)


def _damping(damping: Any) -> "tuple[tuple[float, float], float]":
    """Rayleigh's numbers, and the damping ratio."""
    expected = "a damping ratio, or a pair of Rayleigh's numbers (1/s, s)"
    if damping is None:
        return (0.0, 0.0), 0.0
    found = array("damping", damping)
    if found.dtype.kind not in "iuf" or found.shape not in ((), (2,)):
        raise failure("damping", expected, shown(damping))
    if not np.isfinite(found).all() or (found < 0).any():
        raise failure("damping", "numbers of at least zero", damping)
    return ((0.0, 0.0), float(found)) if found.shape == () else ((float(found[0]), float(found[1])), 0.0)

"""Second derivatives of the linear displacements of springs, in all that they depend on but the points.

With the tangent K, displacements u and the adjoint a, the gradient in a number of the springs is `−aᵀ K_θ u`. Along a change t it changes by

    −(a'ᵀ K_θ u + aᵀ K_θ u' + aᵀ K_θt u),     K a' = −K_t a,     K u' = f_t − K_t u

K is linear in constants and in rest measures, and bilinear in both, so that central differences along t give `K_θt` to rounding, whatever the
step is.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._arguments import failure
from .gradients import SpringValues

if TYPE_CHECKING:
    from .adjoint import Statics, StaticsSolution
else:
    Statics = StaticsSolution = Any

# The share of its numbers by which a spring changes beside which its tangent is asked for: the tangent stays regular.
_BESIDE = 1e-2
# Points, the four arrays of the springs' numbers, forces and displacements.
_INPUTS = 7


def _numbers(constants: Any, contents: Any, rest: Any, rest_contents: Any) -> "tuple[Any, Any, Any, Any]":
    """In the order of the core."""
    return constants, rest, contents, rest_contents


class _Along:
    """A change of all inputs but the points."""

    def __init__(self, statics: Statics, y: "tuple[np.ndarray, ...]", change: "tuple[np.ndarray, ...]", known: StaticsSolution) -> None:
        points, *values, forces, displacement = change
        if np.any(points):
            # Changes that JAX knows to be zero never come here; others are arrays of zeros.
            expected = "second derivatives in constants, rest measures, forces and displacements, where points do not change"
            raise failure("statics", expected, "those in points")
        self.numbers = _numbers(*values)
        self.moves = known._vectors(
            "change", known.along(values=SpringValues(*values), forces=forces, displacement=displacement), any(known._stacked)
        )
        self._statics, self._y = statics, y
        self._pair: "tuple[Any, Any, float] | None" = None

    def beside(self) -> "tuple[Any, Any, float] | None":
        """The tangents on both sides, and twice the share of the change to them; None where no number changes."""
        if self._pair is None and any(np.any(own) for own in self.numbers):
            x, given = self._y[0], _numbers(*self._y[1:5])
            extent = np.ptp(x, axis=0).max()
            # Rest measures may be zero, and are then compared with the body.
            sizes = [np.abs(own).max(initial=0.0) for own in given]
            sizes[1], sizes[3] = max(sizes[1], extent), max(sizes[3], extent ** x.shape[1])
            pairs = zip(sizes, (np.abs(own).max(initial=0.0) for own in self.numbers))
            share = _BESIDE * min(size / most for size, most in pairs if most > 0)
            body, held = self._statics._prepared(x.shape)
            sides = (tuple(own + side * t for own, t in zip(given, self.numbers)) for side in (share, -share))
            more, less = (body.at_rest(x, own, held) for own in sides)
            self._pair = more, less, 2 * share
        return self._pair


def turn(statics: Statics, *given: np.ndarray) -> "list[np.ndarray]":
    """The change of the gradient of ``(w * u).sum()`` along t, of ``(*y, w, *t)``."""
    y, w, change = given[:_INPUTS], given[_INPUTS], given[_INPUTS + 1 :]
    known = statics._known(y)
    held, along = known._held, _Along(statics, y, change, known)
    total: Any = None
    forces, moved = [], []
    for weight, move, (tangent, u, _) in zip(known._vectors("weights", w, any(known._stacked)), along.moves, known._parts):
        nothing = np.zeros(held.shape)
        a, _ = tangent.solve(np.where(held, 0.0, weight), nothing)
        bent = tangent.change(along.numbers, nothing, a)
        turned, _ = tangent.solve(np.where(held, 0.0, -bent), nothing)
        parts = [(1.0, tangent, turned, u), (1.0, tangent, a, move)]
        if (sides := along.beside()) is not None:
            more, less, width = sides
            parts += [(1.0 / width, more, a, u), (-1.0 / width, less, a, u)]
        for factor, at, left, right in parts:
            (constants, rest, contents, rest_contents), points = at.sensitivities(left, right)
            found = [factor * own for own in (points, constants, contents, rest, rest_contents)]
            total = found if total is None else [one + other for one, other in zip(total, found)]
        forces.append(turned)
        moved.append(np.where(held, -bent - tangent.product(turned), 0.0))
    of_forces, of_moved = known._shaped(forces, known._stacked[0]), known._shaped(moved, known._stacked[1])
    return [*(-own for own in total), of_forces, of_moved]


def bend(statics: Statics, *given: np.ndarray) -> "list[np.ndarray]":
    """The change along s of the change of the displacements along t, of ``(*y, *t, *s)``."""
    y = given[:_INPUTS]
    known = statics._known(y)
    first, second = (_Along(statics, y, own, known) for own in (given[_INPUTS : 2 * _INPUTS], given[2 * _INPUTS :]))
    nothing, changes = np.zeros(known._held.shape), []
    for t, s, (tangent, u, _) in zip(first.moves, second.moves, known._parts):
        pull = tangent.change(second.numbers, nothing, t) + tangent.change(first.numbers, nothing, s)
        if (sides := second.beside()) is not None:
            more, less, width = sides
            pull = pull + (more.change(first.numbers, nothing, u) - less.change(first.numbers, nothing, u)) / width
        changes.append(tangent.solve(np.where(known._held, 0.0, -pull), nothing)[0])
    return [known._shaped(changes, any(known._stacked))]

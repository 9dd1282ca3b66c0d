"""The displacements of springs under loads as a function of everything that they depend on, with their derivatives."""

from __future__ import annotations

import copy
import hashlib
from collections import OrderedDict
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np

from . import _core
from ._arguments import array, failure, matrix, shown, typed, warn
from ._jax import Products, of_jax
from ._second import bend, turn
from ._supports import check_acting, check_held, held_flags, vectors
from ._torch import of_torch
from .gradients import SpringConstants, SpringValues
from .network import Network

# Solutions that are kept for the gradients that are asked for after them; at large deformation each has a factor of its own.
KEPT = 2
# A solution that leaves more of the forces than this is warned of.
LEFT = 1e-6


@dataclass(frozen=True)
class StaticsGradient:
    """The derivatives of a number that depends on displacements.

    Attributes:
        points: With respect to the positions at rest, shape (points, dimension), while the springs' numbers stay as they are.
        values: With respect to constants and rest measures, as :class:`SpringValues`.
        forces: With respect to the forces, in their shape; zero where they act on what is held.
        displacement: With respect to the displacements of what is held, in their shape; zero elsewhere.
    """

    points: np.ndarray
    values: SpringValues
    forces: np.ndarray
    displacement: np.ndarray


class StaticsSolution:
    """Displacements with the factor of the tangent, which gives derivatives without another factorisation.

    Attributes:
        displacement: u of each point, m, shape (points, dimension); of several loads (loads, points, dimension).
        is_stable: Whether the tangent is positive definite under the supports, at each of the loads.
        left: The largest share of the forces that a linear solution leaves; zero at large deformation.
    """

    def __init__(
        self, parts: "list[tuple[_core.Tangent, np.ndarray, float]]", held: np.ndarray, is_large: bool, stacked: "tuple[bool, bool]"
    ) -> None:
        """``parts`` has the tangent, the displacements and what is left of each load; ``stacked`` says whether forces and displacements have one
        entry for each load."""
        self._parts, self._held, self._is_large, self._stacked = parts, held, is_large, stacked
        self.displacement = self._shaped([u for _, u, _ in parts], any(stacked))
        self.left = max(left for _, _, left in parts)
        self.is_stable = all(tangent.is_stable for tangent, _, _ in parts)

    @staticmethod
    def _shaped(each: "list[np.ndarray]", is_stacked: bool) -> np.ndarray:
        """What belongs to each load; or the sum, if one array belongs to all of them."""
        return np.stack(each) if is_stacked else np.sum(each, axis=0)

    def _vectors(self, key: str, given: Any, is_stacked: bool) -> np.ndarray:
        """One array for each load."""
        shape = (len(self._parts), *self._held.shape)
        if given is None:
            return np.zeros(shape)
        own = typed(key, array(key, given), np.float64)
        if own.shape != (shape if is_stacked else shape[1:]):
            raise failure(key, f"an array of shape {shape if is_stacked else shape[1:]}", f"one of shape {own.shape}")
        return np.broadcast_to(own, shape)

    def gradient(self, weights: Any) -> StaticsGradient:
        """The derivatives of ``(weights * displacement).sum()``, by the adjoint: one more solution with the factor that is there.

        With the tangent K, free displacements f and held ones h: ``K_ff a = w_f`` gives ``∂/∂forces = a``, ``∂/∂u_h = w_h − K_hf a``, and
        ``−aᵀ (∂K/∂θ) u`` for a number θ of the springs; at large deformation ``−aᵀ ∂F/∂θ``, F being the slopes of the energy.

        Args:
            weights: In the shape of :attr:`displacement`. For a number g(u) they are ``∂g/∂u``.
        """
        held, total = self._held, None
        forces, moved = [], []
        for w, (tangent, u, _) in zip(self._vectors("weights", weights, any(self._stacked)), self._parts):
            a, _ = tangent.solve(np.where(held, 0.0, w), np.zeros(held.shape))
            pull = tangent.product(a)
            (constants, rest, contents, rest_contents), points = tangent.sensitivities(a, None if self._is_large else u)
            if self._is_large:
                # Of what is held the position is that at rest and the displacement; a free point moves to where it is in equilibrium.
                points = np.where(held, pull, w)
            found = [points, constants, contents, rest, rest_contents]
            total = found if total is None else [one + other for one, other in zip(total, found)]
            forces.append(a)
            moved.append(np.where(held, w - pull, 0.0))
        points, *values = (-own for own in total or [])
        of_forces, of_moved = self._shaped(forces, self._stacked[0]), self._shaped(moved, self._stacked[1])
        return StaticsGradient(points, SpringValues(*values), of_forces, of_moved)

    def along(
        self,
        *,
        points: Any = None,
        values: "SpringValues | None" = None,
        forces: Any = None,
        displacement: Any = None,
    ) -> np.ndarray:
        """The change of the displacements along a change of what they depend on, in their shape: one more solution with the factor that is
        there. What is None does not change."""
        moved = self._vectors("points", points, False)[0]
        pulled, held = self._vectors("forces", forces, self._stacked[0]), self._vectors("displacement", displacement, self._stacked[1])
        numbers = None
        if values is not None:
            own = (typed(key, array(key, own).ravel(), np.float64) for key, own in zip(SpringValues._fields, values))
            constants, contents, rest, rest_contents = own
            numbers = (constants, rest, contents, rest_contents)
        changes = []
        for (tangent, u, _), force, given in zip(self._parts, pulled, held):
            if numbers is None:
                numbers = tangent.sensitivities(np.zeros(moved.shape))[0]
            given = np.where(self._held, given, 0.0)
            if self._is_large:
                change = tangent.change(numbers, np.zeros(moved.shape))
                changes.append(tangent.solve(force - change, np.where(self._held, given + moved, 0.0))[0] - moved)
            else:
                changes.append(tangent.solve(force - tangent.change(numbers, moved, u), given)[0])
        return self._shaped(changes, any(self._stacked))


class Statics:
    """The displacements of a body of springs under loads, as a function of points, constants, rest measures, forces and prescribed displacements,
    with derivatives in all of them.

    Args:
        springs: A :class:`SpringConstants`; or a :class:`Network`, whose numbers :attr:`values` has. The force of a spring
            with a law is in proportion to its constant, the slope at rest; the law is an expression.
        fix: What is held: places of points, a flag for each point, or for each component (points, dimension). Groups of a network may be
            named; those of a mesh are ``mesh.groups[name]``.
        large: False for small displacements, ``K u = f`` with the tangent K at rest; True for the equilibrium at any deformation, where
            the slopes of the energy are the forces, found by Newton's method with a line search and load steps.

    The last factor is kept for other loads on the same springs, and the last solutions of :meth:`jax` and :meth:`torch` for their gradients.
    """

    def __init__(self, springs: "SpringConstants | Network", fix: Any, *, large: bool = False) -> None:
        if not isinstance(springs, (SpringConstants, Network)):
            raise failure("springs", "a springfit.SpringConstants or a springfit.Network", shown(springs))
        # A copy, so that an array may be used again for other supports.
        self.springs, self.fix, self.large = springs, copy.deepcopy(fix), bool(large)
        self._groups = springs._groups if isinstance(springs, Network) else None
        if fix is None or (self._groups is None and isinstance(fix, str)):
            raise failure("fix", 'places of points or flags, such as mesh.groups["xmin"]', shown(fix))
        self._body: "tuple[tuple[int, ...], _core.SpringBody, np.ndarray] | None" = None
        self._solutions: "OrderedDict[bytes, StaticsSolution]" = OrderedDict()
        self._last: "tuple[bytes, _core.Tangent] | None" = None

    @property
    def values(self) -> SpringValues:
        """The constants and rest measures of the network; springs on contents are in its own order, cell after cell."""
        if not isinstance(self.springs, Network):
            raise failure("springs", "a springfit.Network, whose numbers are known", "functions of points and moduli")
        _, (constants, rest, contents, rest_contents) = _core.spring_numbers(self.springs._core)
        return SpringValues(constants, contents, rest, rest_contents)

    def _prepared(self, shape: "tuple[int, ...]") -> "tuple[_core.SpringBody, np.ndarray]":
        if self._body is None or self._body[0] != shape:
            held = held_flags(shape, self._groups, self.fix)
            if isinstance(self.springs, Network):
                if shape != self.springs.points.shape:
                    raise failure("points", f"an array of shape {self.springs.points.shape}", f"one of shape {shape}")
                body = _core.SpringBody.of_network(self.springs._core)
            else:
                blocks = list(zip(self.springs._cores, (block.cells for block in self.springs.blocks)))
                body = _core.SpringBody(shape[0], shape[1], self.springs.springs, blocks)
            self._body = shape, body, held
        return self._body[1], self._body[2]

    def __call__(
        self, points: Any, values: SpringValues, *, forces: Any = None, displacement: Any = None, guess: Any = None
    ) -> StaticsSolution:
        """The displacements, with what their derivatives need.

        Args:
            points: Positions at rest, m, shape (points, dimension).
            values: Constants and rest measures, as ``constants(points, young, poisson)`` gives them, or :attr:`values`.
            forces: On the points, N, (points, dimension), or of several loads, (loads, points, dimension); none if None.
            displacement: Of what is held, m, in the same shapes, zero elsewhere; zero if None.
            guess: At large deformation: displacements from which Newton's method starts; from rest if None, or if it finds nothing near them.

        Raises:
            SpringfitError: A motion has no stiffness, an array has a wrong shape, a displacement is given of what is not held, or no
                equilibrium is found; the message says which share of the load has one.
        """
        x = matrix("points", points, np.float64)
        body, held = self._prepared(x.shape)
        loads_of = (("forces", forces), ("displacement", displacement))
        f, u = (np.zeros(x.shape) if given is None else vectors(key, given, x.shape) for key, given in loads_of)
        check_held(u, held)
        if not isinstance(values, tuple) or len(values) != 4:
            raise failure("values", "springfit.SpringValues(constants, contents, rest, rest_contents)", shown(values))
        constants, contents, rest, rest_contents = (typed(key, array(key, own).ravel(), np.float64) for key, own in zip(SpringValues._fields, values))
        numbers = (constants, rest, contents, rest_contents)
        stacked = (f.ndim == 3, u.ndim == 3)
        if f.ndim > 3 or u.ndim > 3 or (all(stacked) and len(f) != len(u)):
            raise failure("displacement", f"as many loads as forces, of shape {f.shape}", f"those of shape {u.shape}")
        loads = np.broadcast_shapes(f.shape, u.shape)[:-2]
        if loads == (0,):
            raise failure("forces", "one load at least", "none")
        stacks = [np.broadcast_to(own, (*(loads or (1,)), *x.shape)) for own in (f, u)]
        check_acting(*stacks, held)
        each = zip(*stacks)
        parts = []
        if self.large:
            start = None if guess is None else np.broadcast_to(vectors("guess", guess, x.shape), (*(loads or (1,)), *x.shape))
            for i, (force, moved) in enumerate(each):
                own = None if start is None else np.ascontiguousarray(start[i])
                found, is_rounded, tangent = body.equilibrium(x, numbers, force, held, moved, own)
                if is_rounded:
                    warn("rounding of the forces limits the accuracy of this equilibrium")
                # As they are given, without the rounding of the positions.
                parts.append((tangent, np.where(held, moved, found), 0.0))
        else:
            key = _mark(x, *numbers)
            if self._last is None or self._last[0] != key:
                # The factor of other springs is dropped before that of these is made.
                self._last = None
                self._last = key, body.at_rest(x, numbers, held)
            tangent = self._last[1]
            parts = [(tangent, *tangent.solve(force, moved)) for force, moved in each]
            worst = max(left for *_, left in parts)
            if not worst < LEFT:
                warn(f"the solution leaves {worst:.1e} of the forces: the network is nearly a mechanism")
        return StaticsSolution(parts, held, self.large, stacked)

    def _known(self, given: "tuple[np.ndarray, ...]") -> StaticsSolution:
        """The solution for these arrays, found before if they are among the last ones."""
        key = _mark(*given)
        if key not in self._solutions:
            points, *values, forces, displacement = given
            _, held = self._prepared(points.shape)
            own = np.where(held, displacement, 0.0)
            self._solutions[key] = self(points, SpringValues(*values), forces=forces, displacement=own)
            while len(self._solutions) > KEPT:
                self._solutions.popitem(last=False)
        self._solutions.move_to_end(key)
        return self._solutions[key]

    @cached_property
    def _products(self) -> Products:
        def pull(*given: np.ndarray) -> "list[np.ndarray]":
            found = self._known(given[:7]).gradient(given[7])
            return [found.points, *found.values, found.forces, found.displacement]

        def push(*given: np.ndarray) -> "list[np.ndarray]":
            points, *values, forces, displacement = given[7:]
            known = self._known(given[:7])
            return [known.along(points=points, values=SpringValues(*values), forces=forces, displacement=displacement)]

        if self.large:
            return Products(lambda *given: [self._known(given).displacement], push, pull)
        turned, bent = partial(turn, self), partial(bend, self)
        return Products(lambda *given: [self._known(given).displacement], push, pull, turned, bent, plain=(0,))

    def jax(self, points: Any, values: SpringValues, forces: Any = None, displacement: Any = None) -> Any:
        """The displacements as an array of JAX, in the shape of the loads, under ``jax.jit``, ``jax.grad``, ``jax.jvp``, ``jax.jacfwd``,
        ``jax.jacrev`` and ``jax.vmap``; of small displacements under ``jax.hessian`` too, but in points. Of ``displacement`` what is not held is
        ignored."""
        import jax.numpy as jnp

        points = jnp.asarray(points)
        forces, displacement = (jnp.zeros(points.shape) if own is None else jnp.asarray(own) for own in (forces, displacement))
        shape = jnp.broadcast_shapes(forces.shape, displacement.shape)
        key = (shape, jnp.result_type(float))
        if key not in self._functions:
            self._functions[key] = of_jax("statics", self._products, 7, [shape])
        return self._functions[key](points, *values, forces, displacement)[0]

    def torch(self, points: Any, values: SpringValues, forces: Any = None, displacement: Any = None) -> Any:
        """The displacements as a tensor of PyTorch, whose ``backward()`` reaches all arguments. Of ``displacement`` what is not held is ignored."""
        import torch

        first = next((own for own in (points, *values, forces, displacement) if isinstance(own, torch.Tensor)), None)
        like = {"dtype": torch.float64} if first is None else {"dtype": first.dtype, "device": first.device}
        points = torch.as_tensor(points, **like)
        forces, displacement = (torch.zeros_like(points) if own is None else own for own in (forces, displacement))
        given = [torch.as_tensor(own, **like) for own in (points, *values, forces, displacement)]
        return of_torch("statics", self._products)(*given)[0]

    @cached_property
    def _functions(self) -> "dict[Any, Any]":
        """Those of JAX by shape and type, because a primitive has one of each."""
        return {}

    def __getstate__(self) -> "dict[str, Any]":
        # A factor stays in its process.
        state = {key: value for key, value in self.__dict__.items() if key not in ("_functions", "_products")}
        return {**state, "_body": None, "_solutions": OrderedDict(), "_last": None}


def _mark(*given: np.ndarray) -> bytes:
    """What tells these arrays from others."""
    mark = hashlib.blake2b(digest_size=16)
    for own in given:
        mark.update(np.ascontiguousarray(own).tobytes())
        mark.update(str(own.shape).encode())
    return mark.digest()

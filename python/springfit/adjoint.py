"""The displacements of springs under loads as a function of everything that they depend on, with their derivatives."""

from __future__ import annotations

import hashlib
from collections import OrderedDict
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from . import _core
from ._arguments import array, failure, matrix, places, shown, typed
from ._jax import Products, of_jax
from ._torch import of_torch
from .gradients import SpringConstants, SpringValues

# Solutions whose factors are kept for the gradients that are asked for after them.
KEPT = 2


@dataclass(frozen=True)
class StaticsGradient:
    """The derivatives of a number that depends on displacements.

    Attributes:
        points: With respect to the positions at rest, shape (points, dimension), while the springs' numbers stay as they are.
        values: With respect to constants and rest measures, as :class:`SpringValues`.
        forces: With respect to the forces, shape (points, dimension); zero where they act on what is held.
        displacement: With respect to the displacements of what is held, shape (points, dimension); zero elsewhere.
    """

    points: np.ndarray
    values: SpringValues
    forces: np.ndarray
    displacement: np.ndarray


class StaticsSolution:
    """Displacements with the factor of the tangent, which gives derivatives without another factorisation.

    Attributes:
        displacement: u of each point, m, shape (points, dimension).
        is_stable: Whether the tangent is positive definite under the supports.
        left: The share of the forces that the linear solution leaves; zero at large deformation.
    """

    def __init__(
        self, tangent: "_core.Tangent", held: np.ndarray, displacement: np.ndarray, left: float, is_large: bool
    ) -> None:
        self._tangent, self._held, self._is_large = tangent, held, is_large
        self.displacement, self.left, self.is_stable = displacement, left, tangent.is_stable

    def _vectors(self, key: str, given: Any) -> np.ndarray:
        if given is None:
            return np.zeros(self._held.shape)
        own = matrix(key, given, np.float64)
        if own.shape != self._held.shape:
            raise failure(key, f"an array of shape {self._held.shape}", f"one of shape {own.shape}")
        return own

    def _solve(self, forces: np.ndarray, displacement: "np.ndarray | None" = None) -> np.ndarray:
        return self._tangent.solve(forces, np.zeros_like(forces) if displacement is None else displacement)[0]

    def gradient(self, weights: Any) -> StaticsGradient:
        """The derivatives of ``(weights * displacement).sum()``, by the adjoint: one more solution with the factor that is there.

        With the tangent K, free displacements f and held ones h: ``K_ff a = w_f`` gives ``∂/∂forces = a``, ``∂/∂u_h = w_h − K_hf a``, and
        ``−aᵀ (∂K/∂θ) u`` for a number θ of the springs; at large deformation ``−aᵀ ∂F/∂θ``, F being the slopes of the energy.

        Args:
            weights: Shape (points, dimension). For a number g(u) they are ``∂g/∂u``.
        """
        w = self._vectors("weights", weights)
        a = self._solve(np.where(self._held, 0.0, w))
        pull = self._tangent.product(a)
        numbers, points = self._tangent.sensitivities(a, None if self._is_large else self.displacement)
        constants, rest, contents, rest_contents = (-own for own in numbers)
        # Of what is held the position is that at rest and the displacement; a free point moves to where it is in equilibrium.
        points = np.where(self._held, -pull, -w) if self._is_large else -points
        held = np.where(self._held, w - pull, 0.0)
        return StaticsGradient(points, SpringValues(constants, contents, rest, rest_contents), a, held)

    def along(
        self,
        *,
        points: Any = None,
        values: "SpringValues | None" = None,
        forces: Any = None,
        displacement: Any = None,
    ) -> np.ndarray:
        """The change of the displacements along a change of what they depend on, shape (points, dimension): one more solution with the factor
        that is there. What is None does not change."""
        moved, pulled = self._vectors("points", points), self._vectors("forces", forces)
        held = np.where(self._held, self._vectors("displacement", displacement), 0.0)
        numbers = self._tangent.sensitivities(np.zeros_like(moved))[0] if values is None else None
        if values is not None:
            constants, contents, rest, rest_contents = (typed(key, array(key, own), np.float64) for key, own in zip(SpringValues._fields, values))
            numbers = (constants, rest, contents, rest_contents)
        if self._is_large:
            change = self._tangent.change(numbers, np.zeros_like(moved))
            return self._solve(pulled - change, np.where(self._held, held + moved, 0.0)) - moved
        change = self._tangent.change(numbers, moved, self.displacement)
        return self._solve(pulled - change, held)


class Statics:
    """The displacements of a body of springs under loads, as a function of points, constants, rest measures, forces and prescribed displacements,
    with derivatives in all of them.

    Args:
        constants: What the springs are, a :class:`SpringConstants`.
        fix: What is held: places of points, a flag for each point, or for each component (points, dimension). A group of a mesh is
            ``mesh.groups[name]``.
        large: False for small displacements, ``K u = f`` with the tangent K at rest; True for the equilibrium at any deformation, where
            the slopes of the energy are the forces, found by Newton's method with a line search and load steps.

    A solution is made once for its gradient: calls of :meth:`jax` and :meth:`torch` keep the last factors.
    """

    def __init__(self, constants: SpringConstants, fix: Any, *, large: bool = False) -> None:
        if not isinstance(constants, SpringConstants):
            raise failure("constants", "a springfit.SpringConstants", shown(constants))
        if isinstance(fix, str) or fix is None:
            raise failure("fix", "places of points or flags, such as mesh.groups[\"xmin\"]", shown(fix))
        self.constants, self.fix, self.large = constants, fix, bool(large)
        self._body: "tuple[tuple, _core.SpringBody, np.ndarray] | None" = None
        self._solutions: "OrderedDict[bytes, StaticsSolution]" = OrderedDict()

    def _prepared(self, shape: "tuple[int, ...]") -> "tuple[_core.SpringBody, np.ndarray]":
        if self._body is None or self._body[0] != shape:
            held = np.zeros(shape, dtype=bool)
            flags = array("fix", self.fix)
            if flags.dtype == bool and flags.shape == shape:
                held[flags] = True
            else:
                held[places("fix", flags, shape[0])] = True
            blocks = list(zip(self.constants._cores, (block.cells for block in self.constants.blocks)))
            self._body = shape, _core.SpringBody(*shape, self.constants.springs, blocks), held
        return self._body[1], self._body[2]

    def __call__(
        self, points: Any, values: SpringValues, *, forces: Any = None, displacement: Any = None, guess: Any = None
    ) -> StaticsSolution:
        """The displacements, with what their derivatives need.

        Args:
            points: Positions at rest, m, shape (points, dimension).
            values: Constants and rest measures, as ``constants(points, young, poisson)`` gives them.
            forces: On the points, N, (points, dimension); none if None.
            displacement: Of what is held, m, (points, dimension), zero elsewhere; zero if None.
            guess: At large deformation: displacements from which Newton's method starts; from rest if None, or if it finds nothing near them.

        Raises:
            SpringfitError: A motion has no stiffness, an array has a wrong shape, a displacement is given of what is not held, or no
                equilibrium is found; the message says which share of the load has one.
        """
        x = matrix("points", points, np.float64)
        body, held = self._prepared(x.shape)
        zero = np.zeros(x.shape)
        f, u = (zero if given is None else matrix(key, given, np.float64) for key, given in (("forces", forces), ("displacement", displacement)))
        for key, given in (("forces", f), ("displacement", u)):
            if given.shape != x.shape:
                raise failure(key, f"an array of shape {x.shape}", f"one of shape {given.shape}")
        loose = np.flatnonzero(((u != 0) & ~held).any(axis=1))
        if loose.size:
            raise failure("displacement", "zero wherever fix does not hold", f"others at {loose.size} points, such as {loose[0]}")
        if not isinstance(values, tuple) or len(values) != 4:
            raise failure("values", "springfit.SpringValues(constants, contents, rest, rest_contents)", shown(values))
        constants, contents, rest, rest_contents = (typed(key, array(key, own).ravel(), np.float64) for key, own in zip(SpringValues._fields, values))
        numbers = (constants, rest, contents, rest_contents)
        if self.large:
            start = None if guess is None else matrix("guess", guess, np.float64)
            found, _, tangent = body.equilibrium(x, numbers, f, held, u, start)
            return StaticsSolution(tangent, held, found, 0.0, True)
        tangent = body.at_rest(x, numbers, held)
        found, left = tangent.solve(f, u)
        return StaticsSolution(tangent, held, found, left, False)

    def _known(self, given: "tuple[np.ndarray, ...]") -> StaticsSolution:
        """The solution for these arrays, found before if they are among the last ones."""
        mark = hashlib.blake2b(digest_size=16)
        for own in given:
            mark.update(np.ascontiguousarray(own).tobytes())
        key = mark.digest()
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

        return Products(lambda *given: [self._known(given).displacement], push, pull)

    def jax(self, points: Any, values: SpringValues, forces: Any = None, displacement: Any = None) -> Any:
        """The displacements as an array of JAX, under ``jax.jit``, ``jax.grad``, ``jax.jvp``, ``jax.jacfwd``, ``jax.jacrev`` and ``jax.vmap``; derivatives are of the
        first order. Of ``displacement`` what is not held is ignored."""
        import jax.numpy as jnp

        points = jnp.asarray(points)
        key = (points.shape, jnp.result_type(float))
        if key not in self._functions:
            self._functions[key] = of_jax("statics", self._products, 7, [points.shape])
        forces, displacement = (jnp.zeros(points.shape) if own is None else own for own in (forces, displacement))
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
        return {**state, "_body": None, "_solutions": OrderedDict()}

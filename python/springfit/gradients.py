"""Spring constants as functions of node positions and moduli, with their derivatives; for NumPy, and for PyTorch and JAX where they are
installed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, NamedTuple

import numpy as np

from . import _core
from ._arguments import PLANES, ElementLike, array, element_of, failure, matrix, shown, typed, word
from ._jax import Products, of_jax
from ._torch import of_torch


class SpringValues(NamedTuple):
    """What springs are made of: arrays of NumPy, PyTorch or JAX.

    Attributes:
        constants: k of each spring between two points, N/m: its energy is ``k (l - rest)²/2``. Shape (springs,).
        contents: k of each spring on the content of a cell or of its quadrature points, or on another measure c: its energy is
            ``k (c - rest)²/2``. Shape (springs on contents,), cell after cell, in the order of the element's file.
        rest: The lengths where springs between two points do not pull, m; zero in exact networks. Shape (springs,).
        rest_contents: The same of springs on contents. They depend on Poisson's ratio in exact networks: ``c₀ = V (1 + μ/(λ + μ))``.
    """

    constants: Any
    contents: Any
    rest: Any
    rest_contents: Any


@dataclass(frozen=True)
class Gradient:
    """The derivatives of a weighted sum of constants and rest measures.

    Attributes:
        points: With respect to the positions, per m, shape (points, dimension).
        young: With respect to Young's modulus, per Pa: a number, or an array by cell if the modulus was one.
        poisson: With respect to Poisson's ratio, as ``young``.
        thickness: With respect to the thickness of a plane body, per m, as ``young``; zero of a solid.
    """

    points: np.ndarray
    young: Any
    poisson: Any
    thickness: Any


@dataclass(frozen=True)
class SpringBlock:
    """The cells of one element in :class:`SpringConstants`.

    Attributes:
        element: The element.
        cells: The nodes of its cells, shape (cells, nodes), read-only.
        place: The place of its cells in arrays by cell: ``young[block.place]``.
        contents: The place of its springs on contents: ``values.contents[block.contents].reshape(len(block.cells), -1)``.
    """

    element: _core.Element
    cells: np.ndarray
    place: slice
    contents: slice


def lame(young: Any, poisson: Any, thickness: Any, dimension: int, plane: "str | None") -> "tuple[Any, Any]":
    """λ and μ of isotropic bodies, in the plane times the thickness; of arrays of any library."""
    mu = young / (2 * (1 + poisson))
    if dimension == 1:
        # A rod has only λ + 2 μ, its stiffness per area.
        return 0 * (young + poisson), young / 2 + 0 * poisson
    if dimension == 2:
        mu = thickness * mu
    if dimension == 2 and plane != "strain":
        return 2 * mu * poisson / (1 - poisson), mu
    return 2 * mu * poisson / (1 - 2 * poisson), mu


class SpringConstants:
    """The spring constants of a body as a function of its points and of its material, with their derivatives.

    Args:
        cells: The nodes of the cells by element, places of points from 0, such as ``{"tet4": array of shape (cells, 4)}``: a dictionary, or a list of
            pairs. An element is a shipped one's name, the path of an element file, or an ``Element``. ``Mesh.cells`` has this form.
        objective: "exact", "frobenius", "offdiag" or "modal". They have derivatives if the optimum has a closed form: without bounds such as
            ``nonnegative=True``, and without ``weight="relative"``. Fits of this kind without a closed form, also "spectral" and
            "divergence", have constants but no derivatives.
        springs: Names of spring groups; all that are not optional, if None.
        plane: The state of a plane body: "stress" (the default) or "strain".
        **keys: The other keys of a ``[[fit]]`` in a scene, such as ``higher=0.3``.

    The cells are copied, and the arrays of this object are read-only.

    Raises:
        SpringfitError: An array or a key is wrong, or the objective is another. :meth:`gradient`, :meth:`along`, and the derivatives of
            :meth:`torch` and :meth:`jax`, raise it where the optimum has no closed form.
    """

    def __init__(
        self,
        cells: "Mapping[ElementLike, Any] | Iterable[tuple[ElementLike, Any]]",
        objective: str = "exact",
        *,
        springs: "list[str] | None" = None,
        plane: Literal["stress", "strain"] | None = None,
        **keys: Any,
    ) -> None:
        form = 'cells by element, such as {"tet4": array of shape (cells, 4)}'
        pairs = list(cells.items()) if isinstance(cells, Mapping) else cells
        if isinstance(pairs, str) or not isinstance(pairs, Iterable):
            raise failure("cells", form, shown(cells))
        self._blocks: "list[SpringBlock]" = []
        self._cores: "list[_core.CellConstants]" = []
        ends, count, others = [], 0, 0
        self.plane = word("plane", plane, PLANES)
        for pair in pairs:
            if not isinstance(pair, (tuple, list)) or len(pair) != 2:
                raise failure("cells", form, shown(pair))
            element = element_of(pair[0])
            # The caller may change the array later.
            own = matrix("cells", pair[1], np.int64).copy()
            own.flags.writeable = False
            if own.shape[1] != element.nodes:
                raise failure("cells", f"an array of shape (cells, {element.nodes}) of {element.name}", f"one of shape {own.shape}")
            core = _core.CellConstants(element, {"objective": objective, "springs": springs, **keys}, self.plane)
            width = (core.springs - len(core.pairs)) * len(own)
            self._blocks.append(SpringBlock(element, own, slice(count, count + len(own)), slice(others, others + width)))
            self._cores.append(core)
            ends.append(own[:, core.pairs].reshape(-1, 2))
            count, others = count + len(own), others + width
        if not self._blocks:
            raise failure("cells", form, "none")
        dimensions = {block.element.dimension for block in self._blocks}
        if len(dimensions) > 1:
            raise failure("cells", "cells of one dimension", f"some of {sorted(dimensions)}")
        self.dimension: int = dimensions.pop()
        self._count, self._others = count, others
        both = np.concatenate(ends)
        if both.size and both.min() < 0:
            raise failure("cells", "places from 0", both.min())
        first, second = np.minimum(both[:, 0], both[:, 1]), np.maximum(both[:, 0], both[:, 1])
        # One number for each pair: sorting rows takes ten times as long.
        width = int(second.max(initial=0)) + 1
        keys_of, places = np.unique(first * width + second, return_inverse=True)
        self._pairs = np.column_stack([keys_of // width, keys_of % width])
        self._pairs.flags.writeable = False
        self._places = places.ravel()
        self._starts = np.cumsum([0, *(len(own) for own in ends)])

    @property
    def blocks(self) -> "list[SpringBlock]":
        """The cells of each element, in the order that was given."""
        return list(self._blocks)

    @property
    def springs(self) -> np.ndarray:
        """The two points of each spring between two points, ascending, shape (springs, 2), read-only."""
        return self._pairs

    def _arrays(self, *given: Any) -> "list[np.ndarray]":
        """Each modulus by cell; one number of all cells is an array of one."""
        named = zip(("young", "poisson", "thickness"), given, ("Pa", "without a unit", "m"))
        found = []
        for key, value, unit in named:
            expected = f"a number, {unit}, or one for each of {self._count} cells"
            if isinstance(value, (str, bytes)) or value is None:
                raise failure(key, expected, shown(value))
            own = array(key, value)
            if own.dtype.kind not in "iuf" or own.shape not in ((), (self._count,)):
                raise failure(key, expected, shown(value) if own.ndim == 0 else f"values of type {own.dtype}, shape {own.shape}")
            found.append(typed(key, own.reshape(-1), np.float64))
        if all(len(own) == 1 for own in found):
            return found
        return [np.broadcast_to(own, self._count).copy() if len(own) == 1 else own for own in found]

    def _points(self, points: Any) -> np.ndarray:
        return matrix("points", points, np.float64)

    def _each(self, by_cell: "list[np.ndarray]") -> "Iterable[tuple]":
        """The compiled part, the cells, the moduli and the places of each block."""
        for i, (core, block) in enumerate(zip(self._cores, self._blocks)):
            own = [values if len(values) == 1 else values[block.place] for values in by_cell]
            yield core, block, own, slice(self._starts[i], self._starts[i + 1])

    def _gathered(self, found: "list[tuple[np.ndarray, np.ndarray]]") -> "tuple[np.ndarray, np.ndarray, np.ndarray]":
        """Numbers of the springs of cells, summed over those between the same points; those on contents; and those of rest contents."""
        lengths = [each[:, : len(core.pairs)].ravel() for core, (each, _) in zip(self._cores, found)]
        contents = [each[:, len(core.pairs) :].ravel() for core, (each, _) in zip(self._cores, found)]
        sums = np.bincount(self._places, np.concatenate(lengths), len(self._pairs))
        return sums, np.concatenate(contents), np.concatenate([rests.ravel() for _, rests in found])

    def _rest_lengths(self, points: np.ndarray) -> "tuple[np.ndarray, np.ndarray]":
        """The rest lengths, and their directions."""
        if self._cores[0].is_restless:
            return np.zeros(len(self._pairs)), np.zeros((len(self._pairs), points.shape[1]))
        edges = points[self._pairs[:, 1]] - points[self._pairs[:, 0]]
        lengths = np.sqrt((edges**2).sum(axis=1))
        return lengths, edges / lengths[:, None]

    def __call__(self, points: Any, young: Any, poisson: Any, thickness: Any = 1.0) -> SpringValues:
        """The constants and the rest measures.

        Args:
            points: m, shape (points, dimension).
            young: Young's modulus, Pa: of all cells, or an array by cell, shape (cells,), element after element.
            poisson: Poisson's ratio, likewise.
            thickness: Of a plane body, m, likewise; a solid has none.

        Returns:
            Those of :attr:`springs`, each the sum of those of its cells, and of the springs on contents, of exact networks one for each
            quadrature point, or one for the cell.
        """
        points = self._points(points)
        found = [
            core.values(points, block.cells, *own)
            for core, block, own, _ in self._each(self._arrays(young, poisson, thickness))
        ]
        constants, contents, rest_contents = self._gathered(found)
        return SpringValues(constants, contents, self._rest_lengths(points)[0], rest_contents)

    def _moduli(self, given: "list[np.ndarray]") -> "list[np.ndarray]":
        """λ and μ by cell, of checked materials."""
        parts = [core.moduli(*own) for core, _, own, _ in self._each(given)]
        if len(given[0]) == 1:
            return list(parts[0])
        return [np.concatenate([part[i] for part in parts]) for i in range(2)]

    def _slopes(self, given: "list[np.ndarray]", moduli: "list[np.ndarray]") -> "tuple[list, list]":
        """The derivatives of λ and of μ in each of E, ν and t."""
        (young, poisson, thickness), (lam, mu) = given, moduli
        zero = 0.0 * young
        if self.dimension == 1:
            return [zero, zero, zero], [mu / young, zero, zero]
        scale = 1 - poisson if self.dimension == 2 and self.plane != "strain" else 1 - 2 * poisson
        # λ = 2 μ ν/s
        mu_poisson = -mu / (1 + poisson)
        lam_poisson = 2 * poisson / scale * mu_poisson + 2 * mu / scale**2
        by = lambda modulus: modulus / thickness if self.dimension == 2 else zero
        return [lam / young, lam_poisson, by(lam)], [mu / young, mu_poisson, by(mu)]

    def gradient(
        self,
        points: Any,
        young: Any,
        poisson: Any,
        thickness: Any = 1.0,
        *,
        weights: Any = None,
        contents: Any = None,
        rest: Any = None,
        rest_contents: Any = None,
    ) -> Gradient:
        """The derivatives of ``weights @ constants + contents @ k of contents + rest @ rest lengths + rest_contents @ rest contents``: the
        product of given vectors and the Jacobian.

        Args:
            weights: Of the constants, shape (springs,); zero if None.
            contents: Of the constants of springs on contents; zero if None.
            rest: Of the rest lengths, shape (springs,); zero if None.
            rest_contents: Of the rest contents; zero if None.

        Raises:
            SpringfitError: An array or a number is wrong, or the optimum has no closed form.
        """
        points, given = self._points(points), self._arrays(young, poisson, thickness)
        moduli = self._moduli(given)
        w = self._weights(weights, contents, rest, rest_contents)
        of_points, of_lambda, of_mu = self._pulled(points, moduli, w)
        (lam_slopes, mu_slopes) = self._slopes(given, moduli)
        slopes = [of_lambda * lam + of_mu * mu for lam, mu in zip(lam_slopes, mu_slopes)]
        shaped = [own if np.ndim(value) else float(own.sum()) for own, value in zip(slopes, (young, poisson, thickness))]
        return Gradient(of_points, *shaped)

    def along(
        self, points: Any, young: Any, poisson: Any, thickness: Any = 1.0, *, changes: "tuple[Any, ...]"
    ) -> SpringValues:
        """The derivatives of all values along a change of the inputs: the product of the Jacobian and a vector.

        Args:
            changes: Of points, young, poisson and, if there is a fourth, thickness; each of the shape of its input, or None of no change.
        """
        points, given = self._points(points), self._arrays(young, poisson, thickness)
        moduli = self._moduli(given)
        change = [np.zeros_like(points) if changes[0] is None else self._points(changes[0])]
        if change[0].shape != points.shape or len(changes) not in (3, 4):
            raise failure("changes", "those of points, young and poisson, and of thickness in the plane", shown(changes))
        moved = self._arrays(*(0.0 if own is None else own for own in (*changes[1:], *([None] if len(changes) == 3 else []))))
        for slopes in self._slopes(given, moduli):
            own = sum(slope * part for slope, part in zip(slopes, moved))
            change.append(np.broadcast_to(own, self._count).copy())
        return SpringValues(*self._pushed(points, moduli, change))

    # The products in λ and μ by cell, of which those in E and ν are made, and the functions of other libraries.

    def _weights(self, *given: Any) -> "list[np.ndarray]":
        sizes = (len(self._pairs), self._others, len(self._pairs), self._others)
        found = []
        for key, value, size in zip(("weights", "contents", "rest", "rest_contents"), given, sizes):
            own = np.zeros(size) if value is None else typed(key, array(key, value), np.float64)
            if own.shape != (size,):
                raise failure(key, f"an array of shape ({size},)", f"one of shape {own.shape}")
            found.append(own)
        return found

    def _by_cell(self, w: "list[np.ndarray]", block: SpringBlock, core: Any, place: slice) -> "tuple[np.ndarray, np.ndarray]":
        """The weights of each cell and of each of its springs."""
        cells = len(block.cells)
        each = np.empty((cells, core.springs))
        each[:, : len(core.pairs)] = w[0][self._places[place]].reshape(cells, -1)
        each[:, len(core.pairs) :] = w[1][block.contents].reshape(cells, -1)
        return each, np.ascontiguousarray(w[3][block.contents].reshape(cells, core.springs - len(core.pairs)))

    def _pulled(self, points: np.ndarray, moduli: Any, w: Any, change: Any = None) -> "list[np.ndarray]":
        """The gradient in points, λ and μ by cell; with a change of these its derivative along it."""
        total, of_moduli = np.zeros_like(points), []
        for core, block, own, place in self._each(list(moduli)):
            moved = None if change is None else (change[0], change[1][block.place], change[2][block.place])
            found = core.gradient(points, block.cells, *own, self._by_cell(w, block, core, place), moved)
            total += found[0]
            of_moduli.append(found[1:])
        if not self._cores[0].is_restless and w[2].any():
            lengths, n = self._rest_lengths(points)
            pull = w[2][:, None] * n
            if change is not None:
                # ∂(w n)/∂d = w (I − n nᵀ)/ℓ
                moved = change[0][self._pairs[:, 1]] - change[0][self._pairs[:, 0]]
                pull = (w[2] / lengths)[:, None] * (moved - n * (n * moved).sum(axis=1, keepdims=True))
            for k in range(points.shape[1]):
                total[:, k] += np.bincount(self._pairs[:, 1], pull[:, k], len(points))
                total[:, k] -= np.bincount(self._pairs[:, 0], pull[:, k], len(points))
        return [total, *(np.concatenate(parts) for parts in zip(*of_moduli))]

    def _pushed(self, points: np.ndarray, moduli: Any, change: Any, other: Any = None) -> "list[np.ndarray]":
        """The derivatives of the values along a change of points, λ and μ by cell; with another change the second ones."""
        found = []
        for core, block, own, _ in self._each(list(moduli)):
            given = [None if c is None else (c[0], c[1][block.place], c[2][block.place]) for c in (change, other)]
            found.append(core.along(points, block.cells, *own, *given))
        constants, contents, rest_contents = self._gathered(found)
        rest = np.zeros(len(self._pairs))
        if not self._cores[0].is_restless:
            lengths, n = self._rest_lengths(points)
            moves = [c[0][self._pairs[:, 1]] - c[0][self._pairs[:, 0]] for c in (change, other) if c is not None]
            along = [(n * move).sum(axis=1) for move in moves]
            rest = along[0] if other is None else ((moves[0] * moves[1]).sum(axis=1) - along[0] * along[1]) / lengths
        return [constants, contents, rest, rest_contents]

    @cached_property
    def _products(self) -> Products:
        """In points, λ and μ by cell."""

        def value(points: np.ndarray, lam: np.ndarray, mu: np.ndarray) -> "list[np.ndarray]":
            young, poisson = self._material(lam, mu)
            return list(self(points, young, poisson))

        return Products(
            value,
            push=lambda x, lam, mu, *t: self._pushed(x, (lam, mu), t),
            pull=lambda x, lam, mu, *w: self._pulled(x, (lam, mu), w),
            turn=lambda x, lam, mu, *given: self._pulled(x, (lam, mu), given[:4], given[4:]),
            bend=lambda x, lam, mu, *given: self._pushed(x, (lam, mu), given[:3], given[3:]),
        )

    def _material(self, lam: np.ndarray, mu: np.ndarray) -> "tuple[np.ndarray, np.ndarray]":
        """E and ν of a thickness of 1 m with these λ and μ."""
        if self.dimension == 1:
            return 2 * mu, 0 * mu
        ratio = lam / (lam + 2 * mu) if self.dimension == 2 and self.plane != "strain" else lam / (2 * (lam + mu))
        return 2 * mu * (1 + ratio), ratio

    def torch(self, points: Any, young: Any, poisson: Any, thickness: Any = 1.0) -> SpringValues:
        """As the call, on tensors of PyTorch: backward() reaches points and moduli, and second derivatives are those of
        ``torch.autograd.grad(..., create_graph=True)``. Numbers are of 64 bits inside."""
        import torch

        given = [points, young, poisson, thickness]
        first = next((value for value in given if isinstance(value, torch.Tensor)), torch.zeros((), dtype=torch.float64))
        points, *moduli = (torch.as_tensor(value, dtype=first.dtype, device=first.device) for value in given)
        moduli = [value.expand(self._count) if value.ndim == 0 else value for value in moduli]
        self._check(moduli)
        lam, mu = lame(moduli[0], moduli[1], moduli[2], self.dimension, self.plane)
        return SpringValues(*of_torch("constants", self._products)(points, lam, mu))

    def jax(self, points: Any, young: Any, poisson: Any, thickness: Any = 1.0) -> SpringValues:
        """As the call, on arrays of JAX: ``jax.jit``, ``jax.grad``, ``jax.jvp``, ``jax.jacfwd``, ``jax.jacrev`` and ``jax.hessian`` pass through, and
        ``jax.vmap``, one body after the other. Numbers are of 64 bits inside."""
        import jax.numpy as jnp

        kind = jnp.result_type(float)
        if kind not in self._functions:
            sizes = (len(self._pairs), self._others, len(self._pairs), self._others)
            self._functions[kind] = of_jax("constants", self._products, 3, [(size,) for size in sizes])
        moduli = [jnp.asarray(value, float) for value in (young, poisson, thickness)]
        self._check(moduli)
        moduli = [jnp.broadcast_to(value, (self._count,)) for value in moduli]
        lam, mu = lame(moduli[0], moduli[1], moduli[2], self.dimension, self.plane)
        return SpringValues(*self._functions[kind](points, lam, mu))

    @cached_property
    def _functions(self) -> "dict[Any, Any]":
        """Those of JAX by their types, because a primitive has one."""
        return {}

    def __getstate__(self) -> "dict[str, Any]":
        return {key: value for key, value in self.__dict__.items() if key not in ("_functions", "_products")}

    def _check(self, moduli: "list[Any]") -> None:
        for key, value in zip(("young", "poisson", "thickness"), moduli):
            if value.shape not in ((), (self._count,)):
                raise failure(key, f"a number, or one for each of {self._count} cells", f"an array of shape {tuple(value.shape)}")

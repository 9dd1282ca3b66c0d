"""Spring constants as functions of node positions and moduli, with their derivatives; for NumPy, and for PyTorch and JAX where they are
installed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

from . import _core
from ._arguments import PLANES, ElementLike, array, element_of, failure, matrix, number, typed, word


@dataclass(frozen=True)
class Gradient:
    """The derivatives of a sum of constants.

    Attributes:
        points: With respect to the positions, per m, shape (points, dimension).
        young: With respect to Young's modulus, per Pa.
        poisson: With respect to Poisson's ratio.
        thickness: With respect to the thickness of a plane body, per m.
    """

    points: np.ndarray
    young: float
    poisson: float
    thickness: float


def _moduli(young: Any, poisson: Any, thickness: Any) -> "tuple[float, float, float]":
    named = (("young", young, "Pa"), ("poisson", poisson, "without a unit"), ("thickness", thickness, "m"))
    young, poisson, thickness = (number(key, value, f"a number, {unit}") for key, value, unit in named)
    return young, poisson, thickness


class SpringConstants:
    """The spring constants of a body of one element, as a function of its points and of its material.

    Args:
        element: A shipped element's name, the path of an element file, or an ``Element``.
        cells: The nodes of its cells, places of points from 0, shape (cells, nodes of the element).
        objective: "exact", "frobenius", "offdiag" or "modal". They have gradients if the optimum has a closed form: without bounds such as
            ``nonnegative=True``, and without ``weight="relative"``. Fits of this kind without a closed form, also "spectral" and
            "divergence", have constants but no gradient.
        springs: Names of spring groups; all that are not optional, if None.
        plane: The state of a plane body: "stress" (the default) or "strain".
        **keys: The other keys of a ``[[fit]]`` in a scene, such as ``higher=0.3``.

    The cells are copied, and :attr:`cells` and :attr:`springs` are read-only.

    Raises:
        SpringfitError: An array or a key is wrong, or the objective is another. :meth:`gradient`, and the gradients of :meth:`torch` and
            :meth:`jax`, raise it where the optimum has no closed form.
    """

    def __init__(
        self,
        element: ElementLike,
        cells: Any,
        objective: str = "exact",
        *,
        springs: "list[str] | None" = None,
        plane: Literal["stress", "strain"] | None = None,
        **keys: Any,
    ) -> None:
        self.element = element_of(element)
        # The caller may change the array later.
        self.cells = matrix("cells", cells, np.int64).copy()
        self.cells.flags.writeable = False
        if self.cells.shape[1] != self.element.nodes:
            raise failure("cells", f"an array of shape (cells, {self.element.nodes})", f"one of shape {self.cells.shape}")
        self._core = _core.CellConstants(self.element, {"objective": objective, "springs": springs, **keys}, word("plane", plane, PLANES))
        ends = np.sort(self.cells[:, self._core.pairs].reshape(-1, 2), axis=1)
        self._pairs, places = np.unique(ends, axis=0, return_inverse=True)
        self._pairs.flags.writeable = False
        self._places = places.ravel()

    @property
    def springs(self) -> np.ndarray:
        """The two points of each spring between two points, ascending, shape (springs, 2), read-only."""
        return self._pairs

    @cached_property
    def _count(self) -> int:
        return len(self._core.pairs)

    def __call__(
        self, points: Any, young: float, poisson: float, thickness: float = 1.0
    ) -> "tuple[np.ndarray, np.ndarray]":
        """The constants.

        Args:
            points: m, shape (points, dimension).
            young: Young's modulus, Pa.
            poisson: Poisson's ratio.
            thickness: Of a plane body, m; a solid has none.

        Returns:
            Those of :attr:`springs`, N/m, shape (springs,), each the sum of those of its cells; and those of the springs on the
            contents of each cell and other measures, shape (cells, others of a cell), in the order of the element's file, of exact
            networks one for each quadrature point, or one for the cell.
        """
        each = self._core.values(matrix("points", points, np.float64), self.cells, *_moduli(young, poisson, thickness))
        sums = np.bincount(self._places, each[:, : self._count].ravel(), len(self._pairs))
        return sums, each[:, self._count :].copy()

    def gradient(
        self, points: Any, young: float, poisson: float, thickness: float = 1.0, *, weights: Any, others: Any = None
    ) -> Gradient:
        """The derivatives of ``weights @ constants + (others * other constants).sum()``: the product of a vector and the Jacobian.

        Args:
            weights: Shape (springs,).
            others: Of the springs on contents, shape (cells, others of a cell); zero if None.

        Raises:
            SpringfitError: An array or a number is wrong, or the optimum has no closed form.
        """
        weights = typed("weights", array("weights", weights), np.float64)
        if weights.shape != (len(self._pairs),):
            raise failure("weights", f"an array of shape ({len(self._pairs)},)", f"one of shape {weights.shape}")
        shape = (len(self.cells), self._core.springs - self._count)
        others = np.zeros(shape) if others is None else typed("others", array("others", others), np.float64)
        if others.shape != shape:
            raise failure("others", f"an array of shape {shape}", f"one of shape {others.shape}")
        each = np.hstack([weights[self._places].reshape(len(self.cells), self._count), others])
        points = matrix("points", points, np.float64)
        found = self._core.gradient(points, self.cells, *_moduli(young, poisson, thickness), each)
        return Gradient(*found)

    def torch(self, points: Any, young: Any, poisson: Any, thickness: Any = 1.0) -> Any:
        """As the call, on tensors of PyTorch: backward() reaches points and moduli. Numbers are of 64 bits inside."""
        import torch

        own = self

        class Constants(torch.autograd.Function):
            @staticmethod
            def forward(ctx: Any, points: Any, *moduli: Any) -> Any:
                ctx.save_for_backward(points, *moduli)
                found = own(points.detach().cpu().numpy(), *map(float, moduli))
                return tuple(torch.as_tensor(array, dtype=points.dtype, device=points.device) for array in found)

            @staticmethod
            @torch.autograd.function.once_differentiable
            def backward(ctx: Any, weights: Any, others: Any) -> Any:
                points, *moduli = ctx.saved_tensors
                given = (points.detach().cpu().numpy(), *map(float, moduli))
                found = own.gradient(*given, weights=weights.cpu().numpy(), others=others.cpu().numpy())
                slopes = (found.points, found.young, found.poisson, found.thickness)
                return tuple(torch.as_tensor(s, dtype=x.dtype, device=x.device) for s, x in zip(slopes, ctx.saved_tensors))

        points = torch.as_tensor(points)
        number = lambda value: torch.as_tensor(value, dtype=points.dtype, device=points.device)
        return Constants.apply(points, number(young), number(poisson), number(thickness))

    @cached_property
    def _jax(self) -> Any:
        import jax
        import jax.numpy as jnp

        shapes = [(len(self._pairs),), (len(self.cells), self._core.springs - self._count)]

        def of_numpy(work: Any, dtype: Any) -> Any:
            """The same function of arrays, with results of this type."""
            return lambda *given: tuple(np.asarray(found, dtype) for found in work(*map(np.asarray, given)))

        @jax.custom_vjp
        def constants(*given: Any) -> Any:
            dtype = jnp.result_type(float)
            results = tuple(jax.ShapeDtypeStruct(shape, dtype) for shape in shapes)
            return jax.pure_callback(of_numpy(self, dtype), results, *given, vmap_method="sequential")

        def forward(*given: Any) -> Any:
            return constants(*given), given

        def backward(given: Any, weights: Any) -> Any:
            def slopes(points: Any, young: Any, poisson: Any, thickness: Any, own: Any, others: Any) -> Any:
                found = self.gradient(points, young, poisson, thickness, weights=own, others=others)
                return found.points, found.young, found.poisson, found.thickness

            dtype = jnp.result_type(float)
            results = tuple(jax.ShapeDtypeStruct(jnp.shape(x), dtype) for x in given)
            found = jax.pure_callback(of_numpy(slopes, dtype), results, *given, *weights, vmap_method="sequential")
            return tuple(slope.astype(jnp.result_type(x)) for slope, x in zip(found, given))

        constants.defvjp(forward, backward)
        return constants

    def jax(self, points: Any, young: Any, poisson: Any, thickness: Any = 1.0) -> Any:
        """As the call, on arrays of JAX: ``jax.grad``, ``jax.jit`` and ``jax.vmap`` pass through, the last one body after the other. Numbers
        are of 64 bits inside."""
        import jax.numpy as jnp

        return self._jax(jnp.asarray(points), *(jnp.asarray(value, float) for value in (young, poisson, thickness)))

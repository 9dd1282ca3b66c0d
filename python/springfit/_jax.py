"""Functions of NumPy arrays as functions of JAX arrays, with the products of their Jacobians in both directions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ._arguments import failure


@dataclass(frozen=True)
class Products:
    """A function y -> f(y) of tuples of arrays, and its products.

    Attributes:
        value: ``value(*y)``, the results f.
        push: ``push(*y, *t)``, the product ``J t`` of the Jacobian with changes of the inputs, as the results.
        pull: ``pull(*y, *w)``, the product ``Jᵀ w`` with weights of the results, as the inputs.
        turn: ``turn(*y, *w, *t)``, the derivative of ``Jᵀ w`` along t; None of a function whose second derivatives are not known.
        bend: ``bend(*y, *t, *s)``, the derivative of ``J t`` along s.
        plain: The places of inputs in which no second derivatives are known.
    """

    value: Callable[..., Sequence[np.ndarray]]
    push: Callable[..., Sequence[np.ndarray]]
    pull: Callable[..., Sequence[np.ndarray]]
    turn: Callable[..., Sequence[np.ndarray]] | None = None
    bend: Callable[..., Sequence[np.ndarray]] | None = None
    plain: Sequence[int] = ()


def of_jax(name: str, products: Products, inputs: int, shapes: Sequence[tuple]) -> Callable[..., tuple]:
    """A function of ``inputs`` arrays of JAX, whose results have these shapes. ``jax.jit``, ``jax.grad``, ``jax.jvp``, ``jax.jacfwd``, ``jax.jacrev``,
    ``jax.hessian`` and ``jax.vmap`` pass through it, the last one call after the other.

    A primitive for each product, because a function of JAX with a rule of its own has one for one direction alone.
    """
    import jax
    import jax.numpy as jnp
    from jax.extend.core import Primitive
    from jax.interpreters import ad, batching, mlir

    array_type = np.dtype(jnp.result_type(float))
    outputs = len(shapes)

    def primitive(kind: str, work: Callable[..., Sequence[np.ndarray]], results: Callable[..., list]) -> Any:
        """``results(*shapes)`` are the shapes of the results by those of the arguments."""
        own = Primitive(f"springfit_{name}_{kind}")
        own.multiple_results = True

        def on_host(*given: Any) -> tuple:
            found = work(*(np.asarray(array, np.float64) for array in given))
            return tuple(np.asarray(array, array_type) for array in found)

        def run(*given: Any) -> Any:
            kinds = tuple(jax.ShapeDtypeStruct(shape, array_type) for shape in results(*map(jnp.shape, given)))
            return jax.pure_callback(on_host, kinds, *given, vmap_method="sequential")

        own.def_impl(lambda *given: list(run(*given)))
        own.def_abstract_eval(lambda *given: [jax.core.ShapedArray(shape, array_type) for shape in results(*(g.shape for g in given))])
        mlir.register_lowering(own, mlir.lower_fun(lambda *given: list(run(*given)), multiple_results=True))

        def batched(given: Any, axes: Any) -> Any:
            # Arrays that do not change are left out of the loop.
            moving = [jnp.moveaxis(array, axis, 0) for array, axis in zip(given, axes) if axis is not None]

            def one(parts: Any) -> list:
                rest = iter(parts)
                return own.bind(*(array if axis is None else next(rest) for array, axis in zip(given, axes)))

            found = jax.lax.map(one, moving)
            return found, [0] * len(found)

        batching.primitive_batchers[own] = batched
        return own

    def none(*_: Any) -> Any:
        raise failure(name, "derivatives of the first order, or those of the constants", "derivatives of a higher one")

    def as_results(*_: Any) -> list:
        return list(shapes)

    def as_inputs(*given: Any) -> list:
        return list(given[:inputs])

    value = primitive("value", products.value, as_results)
    push, pull = primitive("push", products.push, as_results), primitive("pull", products.pull, as_inputs)
    turn, bend = primitive("turn", products.turn or none, as_inputs), primitive("bend", products.bend or none, as_results)

    def is_zero(tangent: Any) -> bool:
        return type(tangent) is ad.Zero

    def filled(tangents: Any) -> list:
        return [ad.instantiate_zeros(tangent) for tangent in tangents]

    def total(first: Any, second: Any) -> Any:
        if first is None or second is None:
            return first if second is None else second
        return [a + b for a, b in zip(first, second)]

    def derivative(own: Any, *parts: Callable[..., Any]) -> None:
        """The rule of a primitive forwards: what follows from the tangents of each group of its arguments, in their order."""

        def rule(primals: Any, tangents: Any) -> Any:
            change = None
            for place, follow in zip(groups[own], parts):
                if not all(map(is_zero, tangents[place])):
                    if own is not value and place.start == 0 and not all(is_zero(tangents[plain]) for plain in products.plain):
                        none()
                    change = total(change, follow(*(primals[place] for place in groups[own]), filled(tangents[place])))
            found = own.bind(*primals)
            return found, [ad.Zero.from_primal_value(array) for array in found] if change is None else change

        ad.primitive_jvps[own] = rule

    def transposed(own: Any, *ways: Callable[..., Any]) -> None:
        """The rule of a primitive backwards, for each group of its arguments but the first: it is linear in the group that is asked for."""

        def rule(cotangents: Any, *given: Any) -> Any:
            slopes: list = [None] * len(given)
            for place, back in zip(groups[own][1:], ways):
                asked = [ad.is_undefined_primal(array) for array in given[place]]
                if any(asked):
                    found = back(*(given[place] for place in groups[own]), filled(cotangents))
                    slopes[place] = [slope if is_asked else None for slope, is_asked in zip(found, asked)]
                    break
            return slopes

        ad.primitive_transposes[own] = rule

    def grouped(*counts: int) -> list:
        ends = np.cumsum([0, *counts]).tolist()
        return [slice(first, last) for first, last in zip(ends, ends[1:])]

    n, m = inputs, outputs
    groups = {
        value: grouped(n), push: grouped(n, n), pull: grouped(n, m), turn: grouped(n, m, n), bend: grouped(n, n, n)
    }
    derivative(value, lambda y, t: push.bind(*y, *t))
    bent = none if products.bend is None else lambda y, t, s: bend.bind(*y, *t, *s)
    turned = none if products.turn is None else lambda y, w, t: turn.bind(*y, *w, *t)
    derivative(push, bent, lambda y, t, s: push.bind(*y, *s))
    derivative(pull, turned, lambda y, w, v: pull.bind(*y, *v))
    derivative(turn, none, lambda y, w, t, v: turn.bind(*y, *v, *t), lambda y, w, t, s: turn.bind(*y, *w, *s))
    derivative(bend, none, lambda y, t, s, r: bend.bind(*y, *r, *s), lambda y, t, s, r: bend.bind(*y, *t, *r))
    transposed(push, lambda y, t, w: pull.bind(*y, *w))
    transposed(pull, lambda y, w, t: push.bind(*y, *t))
    transposed(turn, lambda y, w, t, s: bend.bind(*y, *t, *s), lambda y, w, t, s: turn.bind(*y, *w, *s))
    transposed(bend, lambda y, t, s, w: turn.bind(*y, *w, *s), lambda y, t, s, w: turn.bind(*y, *w, *t))

    def function(*given: Any) -> tuple:
        return tuple(value.bind(*(jnp.asarray(array, array_type) for array in given)))

    return function

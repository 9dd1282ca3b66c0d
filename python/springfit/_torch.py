"""Functions of NumPy arrays as functions of tensors of PyTorch, with the products of their Jacobians."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ._arguments import failure
from ._jax import Products


def of_torch(name: str, products: Products) -> Callable[..., tuple]:
    """The function on tensors. ``backward()``, and where second derivatives are known ``torch.autograd.grad(..., create_graph=True)``, pass
    through it. Numbers are of 64 bits inside."""
    import torch
    from torch.autograd import Function
    from torch.autograd.function import once_differentiable

    def worked(work: Callable[..., Any], like: Any, *given: Any) -> tuple:
        found = work(*(tensor.detach().cpu().numpy().astype(np.float64) for tensor in given))
        # One type and device for all: those of the first argument.
        return tuple(torch.as_tensor(np.ascontiguousarray(array), dtype=like.dtype, device=like.device) for array in found)

    class Value(Function):
        @staticmethod
        def forward(ctx: Any, *y: Any) -> Any:
            found = worked(products.value, y[0], *y)
            ctx.save_for_backward(*y)
            return found

        @staticmethod
        def backward(ctx: Any, *w: Any) -> Any:
            return Pull.apply(*ctx.saved_tensors, *w)

    class Pull(Function):
        @staticmethod
        def forward(ctx: Any, *given: Any) -> Any:
            ctx.save_for_backward(*given)
            return worked(products.pull, given[0], *given)

        @staticmethod
        @once_differentiable
        def backward(ctx: Any, *t: Any) -> Any:
            if products.turn is None:
                raise failure(name, "derivatives of the first order", "those of a gradient")
            given = ctx.saved_tensors
            y = given[: len(t)]
            return (*worked(products.turn, y[0], *given, *t), *worked(products.push, y[0], *y, *t))

    def function(*given: Any) -> tuple:
        first = next((array for array in given if isinstance(array, torch.Tensor)), torch.zeros((), dtype=torch.float64))
        return Value.apply(*(torch.as_tensor(array, dtype=first.dtype, device=first.device) for array in given))

    return function

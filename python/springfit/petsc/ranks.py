"""What ranks say to each other: arrays, and faults that end all of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numpy as np

from .._core import SpringfitError

T = TypeVar("T")


class Ended(Exception):
    """A fault that every rank knows of."""


def together(comm: Any, work: "Callable[[], T]") -> T:
    """What ``work`` gives on this rank. Where it fails on any rank, it has failed on all.

    Raises:
        Ended: An input is wrong on some rank, with the words of the lowest one.
    """
    found: "T | None" = None
    fault = None
    try:
        found = work()
    except SpringfitError as error:
        fault = str(error)
    except MemoryError as error:
        fault = f"rank {comm.rank} of {comm.size}: not enough memory: {error}"
    faults = [words for words in comm.allgather(fault) if words is not None]
    if faults:
        raise Ended(faults[0])
    return cast(T, found)


def send(comm: Any, to: int, arrays: "list[np.ndarray]", words: Any) -> None:
    """Sends arrays, each of fewer than 2³¹ numbers, with what else belongs to them."""
    comm.send((words, [(array.shape, array.dtype.str) for array in arrays]), to)
    for array in arrays:
        comm.Send(np.ascontiguousarray(array), to)


def receive(comm: Any, source: int = 0) -> "tuple[list[np.ndarray], Any]":
    """What :func:`send` sent."""
    words, shapes = comm.recv(source=source)
    arrays = [np.empty(shape, dtype) for shape, dtype in shapes]
    for array in arrays:
        comm.Recv(array, source=source)
    return arrays, words

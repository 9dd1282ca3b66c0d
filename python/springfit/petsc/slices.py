"""Arrays with a row for each point of a body, of which each rank holds a slice; and what ranks ask each other for."""

from __future__ import annotations

from typing import Any

import numpy as np


def exchange(comm: Any, target: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Sends each row to its target rank; the rows that this rank receives, by the rank that sent them, each in its order."""
    order = np.argsort(target, kind="stable")
    counts = np.bincount(target, minlength=comm.size).astype(np.int64)
    incoming = np.empty_like(counts)
    comm.Alltoall(counts, incoming)
    sent = np.ascontiguousarray(rows[order])
    received = np.empty((int(incoming.sum()), *rows.shape[1:]), rows.dtype)
    # Whole rows are counted, so that counts stay small.
    width = int(np.prod(rows.shape[1:], dtype=np.int64)) * rows.dtype.itemsize
    if width:
        from mpi4py import MPI

        row = MPI.BYTE.Create_contiguous(width).Commit()
        comm.Alltoallv([sent, counts, row], [received, incoming, row])
        row.Free()
    return received


class Slices:
    """Points of a body in equal slices of their places in the mesh.

    Attributes:
        first: The place of the first point of this rank.
        count: How many it has.
        total: How many all have.
    """

    def __init__(self, comm: Any, total: int) -> None:
        self._comm, self.total = comm, total
        self._starts = np.array([start(total, comm.size, rank) for rank in range(comm.size + 1)])
        self.first = int(self._starts[comm.rank])
        self.count = int(self._starts[comm.rank + 1]) - self.first

    def holder(self, places: np.ndarray) -> np.ndarray:
        """The rank whose slice has each place."""
        return np.searchsorted(self._starts, places, side="right") - 1

    def found(self, places: np.ndarray, *arrays: np.ndarray) -> "list[np.ndarray]":
        """The rows of arrays at ``places``, each array having the rows of this rank's slice."""
        comm, holder = self._comm, self.holder(places)
        wanted = exchange(comm, holder, places)
        asked = exchange(comm, holder, np.full(len(places), comm.rank))
        # What comes back is ordered by the rank that has it, as what was sent.
        order = np.argsort(holder, kind="stable")
        found = []
        for array in arrays:
            back = exchange(comm, asked, array[wanted - self.first])
            rows = np.empty_like(back)
            rows[order] = back
            found.append(rows)
        return found

    def count_each(self, places: np.ndarray) -> np.ndarray:
        """How many ranks name each point of this rank's slice; ``places`` are without repetition."""
        named = exchange(self._comm, self.holder(places), places)
        return np.bincount(named - self.first, minlength=self.count)


def start(total: int, ranks: int, rank: int) -> int:
    """Where the slice of a rank begins."""
    return total * rank // ranks

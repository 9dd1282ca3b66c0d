"""Which rank has which points and cells."""

from __future__ import annotations

from typing import Any

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from . import PARTITIONERS
from .slices import Slices, exchange

#: Bisections of a coordinate's range: its rounding is reached.
HALVINGS = 60


def parts_of(comm: Any, slices: Slices, points: np.ndarray, blocks: "list[np.ndarray]", kind: "str | None") -> "tuple[np.ndarray, str]":
    """The rank of each point of this rank's slice, and the partitioner that has found it.

    Args:
        points: Of the slice, m, (count, dimension).
        blocks: Nodes of some cells, places in the mesh; those of all ranks are the cells of the body.
        kind: One of PARTITIONERS; the first that there is, if None.
    """
    if comm.size == 1:
        return np.zeros(slices.count, np.int32), "none"
    for name in PARTITIONERS if kind is None else (kind,):
        part = bisected(comm, slices, points) if name == "bisection" else _by_graph(comm, slices, blocks, name)
        if part is None:
            continue
        # Of a small body a partitioner may leave a rank without points.
        if name == "bisection" or comm.allreduce(np.bincount(part, minlength=comm.size), MPI.SUM).min() > 0:
            return part, name
    return bisected(comm, slices, points), "bisection"


def _by_graph(comm: Any, slices: Slices, blocks: "list[np.ndarray]", kind: str) -> "np.ndarray | None":
    """By a partitioner of PETSc on the graph of points that share a cell; None if PETSc is without it."""
    partitioning = PETSc.MatPartitioning().create(comm)
    try:
        partitioning.setType(kind)
    except PETSc.Error:
        partitioning.destroy()
        return None
    starts, columns = graph(comm, slices, blocks)
    sizes = (slices.count, slices.total)
    given = (starts.astype(PETSc.IntType), columns.astype(PETSc.IntType), np.ones(len(columns)))
    matrix = PETSc.Mat().createAIJ((sizes, sizes), csr=given, comm=comm)
    partitioning.setAdjacency(matrix)
    partitioning.setFromOptions()
    found = PETSc.IS()
    partitioning.apply(found)
    part = found.getIndices().astype(np.int32)
    for own in (found, matrix, partitioning):
        own.destroy()
    return part


def graph(comm: Any, slices: Slices, blocks: "list[np.ndarray]") -> "tuple[np.ndarray, np.ndarray]":
    """The other points of the cells of each point of the slice, in rows: where each row begins, and the places."""
    total, own = slices.total, []
    for nodes in blocks:
        for column in range(nodes.shape[1] - 1):
            for other in range(column + 1, nodes.shape[1]):
                # A pair as one number, ordered by its first point.
                own.append(np.unique(nodes[:, column] * total + nodes[:, other]))
                own.append(np.unique(nodes[:, other] * total + nodes[:, column]))
    pairs = np.unique(np.concatenate(own)) if own else np.zeros(0, np.int64)
    pairs = np.unique(exchange(comm, slices.holder(pairs // total), pairs))
    rows = pairs // total - slices.first
    return np.concatenate([[0], np.cumsum(np.bincount(rows, minlength=slices.count))]), pairs % total


def bisected(comm: Any, slices: Slices, points: np.ndarray) -> np.ndarray:
    """By recursive coordinate bisection: the longest side of the bounding box is cut where the numbers of points on both sides are as
    those of the parts (Berger, Bokhari 1987). Points in one plane are cut in the order of the mesh."""
    part = np.zeros(slices.count, np.int32)
    waiting = [(0, comm.size)]
    while waiting:
        first, count = waiting.pop()
        if count == 1:
            continue
        members = np.flatnonzero(part == first)
        own = points[members]
        low, high = own.min(axis=0, initial=np.inf), own.max(axis=0, initial=-np.inf)
        comm.Allreduce(MPI.IN_PLACE, low, MPI.MIN)
        comm.Allreduce(MPI.IN_PLACE, high, MPI.MAX)
        axis = int(np.argmax(high - low))
        along = own[:, axis]
        below = count // 2
        target = comm.allreduce(len(members), MPI.SUM) * below // count
        cut = _cut(comm, along, low[axis], high[axis], target)
        is_above = along > cut
        level = np.flatnonzero(along == cut)
        room = target - comm.allreduce(int(np.count_nonzero(along < cut)), MPI.SUM)
        before = comm.scan(len(level), MPI.SUM) - len(level)
        is_above[level[max(0, room - before) :]] = True
        part[members[is_above]] = first + below
        waiting += [(first, below), (first + below, count - below)]
    return part


def _cut(comm: Any, along: np.ndarray, low: float, high: float, target: int) -> float:
    """The coordinate of the point with this number in their order, over all ranks."""
    for _ in range(HALVINGS):
        middle = low + (high - low) / 2
        if comm.allreduce(int(np.count_nonzero(along <= middle)), MPI.SUM) > target:
            high = middle
        else:
            low = middle
    # The largest coordinate that is not above the interval.
    return float(comm.allreduce(along[along <= high].max(initial=-np.inf), MPI.MAX))


def ranks_of(parts: np.ndarray) -> np.ndarray:
    """The rank of each cell, from those of its nodes, (cells, nodes): the middle one, so that cells between two ranks go to either."""
    return np.sort(parts, axis=1)[:, parts.shape[1] // 2]

"""The cells and points of each rank."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from .. import _core
from .partition import parts_of, ranks_of
from .ranks import receive, send, together
from .slices import Slices, exchange, start


@dataclass
class Load:
    """A load on the points that a rank owns, each array of shape (owned, dimension)."""

    name: str
    forces: np.ndarray
    held: np.ndarray
    prescribed: np.ndarray
    support: int


@dataclass
class Share:
    """What one rank has of the mesh.

    Attributes:
        points: Of its cells, m, shape (points, dimension).
        blocks: Element names and the nodes of its cells, places in ``points``.
        numbers: Of its points in the order of all ranks, in which each rank owns a range.
        places: Of its points in the mesh.
        tags: Of its points in the file of the mesh, if that has numbers.
        is_inside: Which of its points belong to no cell of another rank.
        total: The number of all points.
    """

    points: np.ndarray
    blocks: "list[tuple[str, np.ndarray]]"
    numbers: np.ndarray
    places: np.ndarray
    tags: "np.ndarray | None"
    is_inside: np.ndarray
    total: int


@dataclass
class Body:
    """What a rank has of the scene. ``points`` are those that it owns, m, (owned, dimension)."""

    comm: Any
    title: str
    fits: "list[str]"
    cells: int
    points: np.ndarray
    loads: "list[Load]"
    share: Share
    core: Any
    checksum: str
    partitioner: str
    seconds: "dict[str, float]" = field(default_factory=dict)

    @contextmanager
    def timed(self, stage: str) -> "Iterator[None]":
        """Adds the time of the slowest rank to that of a stage, s."""
        self.comm.Barrier()
        start = time.perf_counter()
        yield
        own = time.perf_counter() - start
        self.seconds[stage] = self.seconds.get(stage, 0.0) + self.comm.allreduce(own, MPI.MAX)


def share_out(comm: Any, scene: Path, settings: dict, kind: "str | None") -> Body:
    """Reads the scene on the first rank, which gives each rank a slice of points and of cells; ranks then find the partition together and
    exchange what belongs to others.

    Raises:
        Ended: The scene is wrong, or asks for what several machines do not do.
    """
    begin = time.perf_counter()
    body = together(comm, lambda: _core.DistributedBody(scene, Path("."), settings) if comm.rank == 0 else None)
    words = None if body is None else (body.source, body.title, body.fits, body.counts, body.loads, body.elements, body.checksum, body.is_numbered)
    source, title, fits, (total, cells), names, elements, checksum, is_numbered = comm.bcast(words)
    expected = f"mpirun: expected at most as many ranks as cells, {cells}, found {comm.size}"
    together(comm, lambda: refuse(None if cells >= comm.size else expected))
    slices = Slices(comm, total)
    points, tags, *rest = _slice(comm, body, total, is_numbered)
    del body
    blocks, rows = rest[: len(elements)], [points, *rest[len(elements) :]]
    part, partitioner = parts_of(comm, slices, points, blocks, kind)
    share = _share(comm, slices, part, points, tags if is_numbered else None, list(zip(elements, blocks)))
    del blocks, rest
    owned, *loaded = [exchange(comm, part, array) for array in rows]
    each = [loaded[i : i + 3] for i in range(0, len(loaded), 3)]
    kinds = supports(comm, each)
    loads = [Load(name, forces, held, given, support) for name, (forces, held, given), support in zip(names, each, kinds)]
    text, path = source
    core = together(comm, lambda: _core.BodyShare(text, path, settings, share.points, share.blocks))
    own = Body(comm, title, fits, cells, owned, loads, share, core, checksum, partitioner)
    own.seconds["partition"] = comm.allreduce(time.perf_counter() - begin, MPI.MAX)
    return own


def _slice(comm: Any, body: Any, total: int, is_numbered: bool) -> "list[np.ndarray]":
    """The slice of this rank: points, their numbers, the cells of each block, and three arrays for each load."""
    if comm.rank > 0:
        return receive(comm)[0]
    own: "list[np.ndarray]" = []
    for rank in range(comm.size):
        first = start(total, comm.size, rank)
        count = start(total, comm.size, rank + 1) - first
        arrays = [body.points(first, count), body.numbers(first, count) if is_numbered else np.zeros(0, np.int64)]
        for block, size in enumerate(body.sizes):
            begin = start(size, comm.size, rank)
            arrays.append(body.cells(block, begin, start(size, comm.size, rank + 1) - begin))
        for load in range(len(body.loads)):
            arrays += body.load(load, first, count)
        if rank == 0:
            own = arrays
        else:
            send(comm, rank, arrays, None)
    return own


def _share(
    comm: Any,
    slices: Slices,
    part: np.ndarray,
    points: np.ndarray,
    tags: "np.ndarray | None",
    blocks: "list[tuple[str, np.ndarray]]",
) -> Share:
    """The cells of this rank with their points, of slices of all."""
    targets, inverse = [], None
    used = np.unique(np.concatenate([nodes.ravel() for _, nodes in blocks]))
    (known,) = slices.found(used, part)
    for _, nodes in blocks:
        inverse = np.searchsorted(used, nodes)
        targets.append(ranks_of(known[inverse]))
    del used, known, inverse
    mine = sum(np.bincount(target, minlength=comm.size) for target in targets)
    if comm.allreduce(mine, MPI.SUM).min() == 0:
        # Of a body of few cells each rank has those of its slice.
        targets = [np.full(len(nodes), comm.rank) for _, nodes in blocks]
    own = [(name, exchange(comm, target, nodes)) for (name, nodes), target in zip(blocks, targets)]
    own = [(name, nodes) for name, nodes in own if len(nodes)]
    places = np.unique(np.concatenate([nodes.ravel() for _, nodes in own])) if own else np.zeros(0, np.int64)
    local = [(name, np.searchsorted(places, nodes)) for name, nodes in own]
    numbers, is_inside = _numbers(comm, part), slices.count_each(places) == 1
    # Numbers of the mesh file are those of the places where it has none.
    wanted = (points, numbers, is_inside, tags if tags is not None else numbers)
    mine, numbers, is_inside, found = slices.found(places, *wanted)
    return Share(mine, local, numbers, places, found if tags is not None else None, is_inside, slices.total)


def _numbers(comm: Any, part: np.ndarray) -> np.ndarray:
    """The number of each point of this rank's slice in the order of all ranks: by its rank, then by its place."""
    counts = np.bincount(part, minlength=comm.size).astype(np.int64)
    sums = comm.allreduce(counts, MPI.SUM)
    first = np.cumsum(sums) - sums + comm.scan(counts, MPI.SUM) - counts
    order = np.argsort(part, kind="stable")
    numbers = np.empty(len(part), np.int64)
    numbers[order] = np.arange(len(part)) - np.repeat(np.cumsum(counts) - counts, counts) + np.repeat(first, counts)
    return numbers


def refuse(fault: "str | None") -> None:
    """Raises a fault, if there is one."""
    if fault is not None:
        raise _core.SpringfitError(fault)


def supports(comm: Any, loads: "list[list[np.ndarray]]") -> "list[int]":
    """For each load the first load with the same support on all ranks, whose equations it shares."""
    same = lambda a, b: np.array_equal(a[1], b[1]) and np.array_equal(a[2], b[2])
    every = np.array([[same(a, b) for b in loads] for a in loads], np.uint8)
    comm.Allreduce(MPI.IN_PLACE, every, MPI.MIN)
    return [int(np.argmax(row)) for row in every]

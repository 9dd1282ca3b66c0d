"""A scene on all ranks: partition, fits, equations, errors."""

from __future__ import annotations

import resource
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from .. import _core
from .equations import Equations, assemble
from .partition import Partition, Share
from .ranks import receive, send, together


@dataclass
class Load:
    """A load on the points that a rank owns, each array of shape (owned, dimension)."""

    name: str
    forces: np.ndarray
    held: np.ndarray
    prescribed: np.ndarray
    support: int


@dataclass
class Body:
    """What a rank has of the scene."""

    comm: Any
    title: str
    fits: "list[str]"
    cells: int
    points: np.ndarray
    loads: "list[Load]"
    share: Share
    core: Any
    identity: tuple
    seconds: "dict[str, float]" = field(default_factory=dict)

    @contextmanager
    def timed(self, stage: str) -> "Iterator[None]":
        """Adds the time of the slowest rank to that of a stage, s."""
        self.comm.Barrier()
        start = time.perf_counter()
        yield
        own = time.perf_counter() - start
        self.seconds[stage] = self.seconds.get(stage, 0.0) + self.comm.allreduce(own, MPI.MAX)


def share_out(comm: Any, scene: Path, settings: dict) -> Body:
    """Reads the scene on the first rank and gives each rank its cells.

    Raises:
        Ended: The scene is wrong, or asks for what several machines do not do.
    """
    start = time.perf_counter()
    read = lambda: _core.distributed(scene, Path("."), settings) if comm.rank == 0 else None
    found = together(comm, read)
    words, own = None, None
    if comm.rank == 0:
        source, title, fits, mesh, loads = found
        blocks = mesh.blocks
        cells = sum(len(nodes) for _, nodes in blocks)
        fault = None if cells >= comm.size else f"mpirun: expected at most as many ranks as cells, {cells}, found {comm.size}"
        words = (source, title, fits, cells, [name for name, *_ in loads], supports([load[2:4] for load in loads]), fault)
    words = comm.bcast(words)
    source, title, fits, cells, names, kinds, fault = words
    together(comm, lambda: _refuse(fault))
    if comm.rank == 0:
        partition = Partition(mesh.points, blocks, comm.size)
        for rank, share in enumerate(partition.shares()):
            owned = partition.owned(rank)
            own_numbers = share.places if mesh.numbers is None else mesh.numbers[share.places]
            arrays = [share.points, share.numbers, share.places, own_numbers, share.is_inside, mesh.points[owned]]
            arrays += [nodes for _, nodes in share.blocks]
            arrays += [array[owned] for load in loads for array in load[1:4]]
            words = (share.total, [name for name, _ in share.blocks], mesh.checksum, mesh.numbers is not None)
            if rank == 0:
                own = (arrays, words)
            else:
                send(comm, rank, arrays, words)
    arrays, (total, elements, checksum, is_numbered) = own if own is not None else receive(comm)
    points, numbers, places, tags, is_inside, owned, *rest = arrays
    share = Share(points, list(zip(elements, rest)), numbers, places, is_inside, total)
    each = rest[len(elements) :]
    loads = [Load(name, *each[3 * i : 3 * i + 3], support) for i, (name, support) in enumerate(zip(names, kinds))]
    text, path = source
    core = together(comm, lambda: _core.BodyShare(text, path, settings, share.points, share.blocks))
    identity = (checksum, total, cells, tags if is_numbered else None)
    body = Body(comm, title, fits, cells, owned, loads, share, core, identity)
    body.seconds["partition"] = comm.allreduce(time.perf_counter() - start, MPI.MAX)
    return body


def _refuse(fault: "str | None") -> None:
    if fault is not None:
        raise _core.SpringfitError(fault)


def supports(loads: "list[tuple[np.ndarray, np.ndarray]]") -> "list[int]":
    """For each load the first load with the same support, whose equations it shares."""
    same = lambda a, b: np.array_equal(a[0], b[0]) and np.array_equal(a[1], b[1])
    return [next(j for j, other in enumerate(loads) if same(load, other)) for load in loads]


def solve_model(
    body: Body, blocks: tuple, stage: str, levels: "dict[int, Equations]", keep: bool
) -> "tuple[list[tuple[np.ndarray | None, int, float, bool]], dict[int, Equations]]":
    """The answers of a model to all loads; ``blocks`` is the matrix of the cells of this rank. ``levels`` are the equations of the finite
    elements. An answer is the displacements of the points of this rank, iterations, the residual, and whether the model is indefinite. The
    equations of the model are returned if they are to be kept."""
    dimension = body.points.shape[1]
    with body.timed(f"{stage}: assembly"):
        matrix = assemble(body.comm, blocks, body.share.numbers, len(body.points), body.share.total, dimension)
        # As large as the matrix.
        del blocks
    answers: list = [None] * len(body.loads)
    kinds = sorted({load.support for load in body.loads})
    kept: "dict[int, Equations]" = {}
    for kind in kinds:
        first = body.loads[kind]
        with body.timed(f"{stage}: levels"):
            equations = Equations(matrix, body.points, first.held, first.prescribed, kind != kinds[-1], levels.get(kind))
            equations.setup()
        with body.timed(f"{stage}: iterations"):
            for i, load in enumerate(body.loads):
                if load.support == kind:
                    answers[i] = (*equations.solve(load.forces), equations.indefinite)
        if keep:
            kept[kind] = equations
        else:
            equations.destroy()
    return answers, kept


def errors(comm: Any, fem: np.ndarray, lem: np.ndarray) -> "dict[str, float] | None":
    """The distances of the points of a network from those of the finite elements, in percent of the largest displacement, over all ranks.
    None where the finite elements do not move."""
    size, apart = np.linalg.norm(fem, axis=1), np.linalg.norm(fem - lem, axis=1)
    far = int(np.argmax(size)) if len(size) else 0
    tips = comm.allgather((size[far], apart[far]) if len(size) else (0.0, 0.0))
    largest, tip = max(tips)
    if not largest > 0:
        return None
    square = comm.allreduce(float(np.sum((apart / largest) ** 2)), MPI.SUM)
    points = comm.allreduce(len(size), MPI.SUM)
    worst = comm.allreduce(float(apart.max(initial=0.0)), MPI.MAX)
    return {"e_rms": 100 * np.sqrt(square / points), "e_max": 100 * worst / largest, "e_tip": 100 * tip / largest}


def fitted(body: Body, index: int) -> tuple:
    """The seconds, the springs and the matrix of the cells of this rank by one fit."""
    blocks, seconds, springs = body.core.fit(index)
    return seconds, springs, blocks


def write_shards(body: Body, index: int, springs: Any, folder: Path) -> "list[str]":
    """Writes the springs of each rank by one fit; the names of all files."""
    comm, (checksum, total, cells, tags) = body.comm, body.identity
    stem = "".join(c if c.isalnum() or c in "-." else "-" for c in body.fits[index])
    name = lambda rank: f"{index + 1}-{stem}-{rank + 1}-of-{comm.size}.shard"
    fit = f"{body.title}: fit {index + 1} on {comm.size} ranks: {body.fits[index]}"
    place = (comm.rank + 1, comm.size)
    write = lambda: body.core.write(
        springs, folder / name(comm.rank), place, (checksum, total, cells, fit), body.share.places, tags, body.share.is_inside
    )
    together(comm, write)
    return [name(rank) for rank in range(comm.size)]


def run(comm: Any, scene: Path, settings: dict, out: "Path | None" = None) -> dict:
    """Runs a scene; the report is the same on all ranks. With ``out`` the springs of each rank are written into that folder, which all
    ranks see.

    Raises:
        Ended: An input is wrong, or the equations of the finite elements cannot be solved.
    """
    body = share_out(comm, scene, settings)
    fem, levels = solve_model(body, together(comm, body.core.stiffness), "finite elements", {}, True)
    for load, (u, _, left, _) in zip(body.loads, fem):
        problem = f"mesh: expected equations that can be solved to 1e-6 of the forces, found {left:.1e} left under load \"{load.name}\""
        together(comm, lambda: _refuse(problem if u is None else None))
    fits = []
    for index, name in enumerate(body.fits):
        with body.timed("fits"):
            seconds, springs, *blocks = together(comm, lambda: fitted(body, index))
        answers, _ = solve_model(body, blocks.pop(), "networks", levels, False)
        loads = []
        for load, (u, iterations, left, indefinite), known in zip(body.loads, answers, fem):
            found = None if u is None else errors(comm, known[0], u)
            none = {"e_rms": None, "e_max": None, "e_tip": None}
            loads.append({"name": load.name, **(found or none), "iterations": iterations, "residual": left, "indefinite": indefinite})
        fits.append({"name": name, "seconds": comm.allreduce(seconds, MPI.MAX), "loads": loads})
        if out is not None:
            fits[-1]["files"] = write_shards(body, index, springs, out)
    return {
        "scene": body.title,
        "ranks": comm.size,
        "nodes": body.share.total,
        "elements": body.cells,
        "unknowns": comm.allreduce(int(np.count_nonzero(~body.loads[0].held)), MPI.SUM),
        "loads": [{"name": load.name, "iterations": n, "residual": left} for load, (_, n, left, _) in zip(body.loads, fem)],
        "fits": fits,
        "seconds": body.seconds,
        "seconds_processor": comm.allgather(time.process_time()),
        "bytes": [1024 * peak for peak in comm.allgather(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)],
        "shared_points": comm.allreduce(len(body.share.numbers), MPI.SUM) - body.share.total,
    }

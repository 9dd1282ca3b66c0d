"""A scene on all ranks: partition, fits, equations, errors."""

from __future__ import annotations

import resource
import time
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from .equations import Equations, assemble
from .ranks import together
from .share import Body, refuse, share_out


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
    largest = comm.allreduce(float(size.max(initial=0.0)), MPI.MAX)
    if not largest > 0:
        return None
    # Rounding would decide between points that a symmetry of the body makes equal.
    tip = comm.allreduce(float(apart[size >= (1 - 1e-6) * largest].max(initial=0.0)), MPI.MAX)
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
    comm, share = body.comm, body.share
    stem = "".join(c if c.isalnum() or c in "-." else "-" for c in body.fits[index])
    name = lambda rank: f"{index + 1}-{stem}-{rank + 1}-of-{comm.size}.shard"
    fit = f"{body.title}: fit {index + 1} on {comm.size} ranks: {body.fits[index]}"
    place = (comm.rank + 1, comm.size)
    whole = (body.checksum, share.total, body.cells, fit)
    write = lambda: body.core.write(springs, folder / name(comm.rank), place, whole, share.places, share.tags, share.is_inside)
    together(comm, write)
    return [name(rank) for rank in range(comm.size)]


def run(comm: Any, scene: Path, settings: dict, out: "Path | None" = None, partitioner: "str | None" = None) -> dict:
    """Runs a scene; the report is the same on all ranks. With ``out`` the springs of each rank are written into that folder, which all
    ranks see. ``partitioner`` is one of ``PARTITIONERS``; the first that PETSc has, if None.

    Raises:
        Ended: An input is wrong, or the equations of the finite elements cannot be solved.
    """
    body = share_out(comm, scene, settings, partitioner)
    shared = _peaks(comm)
    fem, levels = solve_model(body, together(comm, body.core.stiffness), "finite elements", {}, True)
    moved = []
    for load, (u, _, left, _) in zip(body.loads, fem):
        problem = f"mesh: expected equations that can be solved to 1e-6 of the forces, found {left:.1e} left under load \"{load.name}\""
        together(comm, lambda: refuse(problem if u is None else None))
        if u is not None:
            moved.append(u)
    fits = []
    for index, name in enumerate(body.fits):
        with body.timed("fits"):
            seconds, springs, *blocks = together(comm, lambda: fitted(body, index))
        answers, _ = solve_model(body, blocks.pop(), "networks", levels, False)
        loads = []
        for load, (u, iterations, left, indefinite), known in zip(body.loads, answers, moved):
            found = None if u is None else errors(comm, known, u)
            none = {"e_rms": None, "e_max": None, "e_tip": None}
            loads.append({"name": load.name, **(found or none), "iterations": iterations, "residual": left, "indefinite": indefinite})
        fits.append({"name": name, "seconds": comm.allreduce(seconds, MPI.MAX), "loads": loads})
        if out is not None:
            fits[-1]["files"] = write_shards(body, index, springs, out)
    return {
        "scene": body.title,
        "ranks": comm.size,
        "partitioner": body.partitioner,
        "nodes": body.share.total,
        "elements": body.cells,
        "unknowns": comm.allreduce(int(np.count_nonzero(~body.loads[0].held)), MPI.SUM),
        "loads": [{"name": load.name, "iterations": n, "residual": left} for load, (_, n, left, _) in zip(body.loads, fem)],
        "fits": fits,
        "seconds": body.seconds,
        "seconds_processor": comm.allgather(time.process_time()),
        "bytes": _peaks(comm),
        "bytes_partition": shared,
        "cells_of_ranks": comm.allgather(sum(len(nodes) for _, nodes in body.share.blocks)),
        "shared_points": comm.allreduce(len(body.share.numbers), MPI.SUM) - body.share.total,
    }


def _peaks(comm: Any) -> "list[int]":
    """The most memory that each rank has had so far, bytes."""
    return [1024 * peak for peak in comm.allgather(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)]

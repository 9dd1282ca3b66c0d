"""The program: ``mpirun -n P python -m springfit.petsc SCENE``."""

from __future__ import annotations

import argparse
import json
import os
import sys
import traceback
from pathlib import Path

from . import PARTITIONERS

MISSING = (
    "petsc4py and mpi4py are required; on Debian: apt-get install python3-petsc4py python3-mpi4py, an environment of /usr/bin/python3 with"
    " --system-site-packages, and PETSC_DIR=/usr/lib/petscdir/petsc*/*-real"
)


def arguments(given: "list[str]") -> "tuple[argparse.Namespace, list[str]]":
    parser = argparse.ArgumentParser(
        prog="springfit.petsc",
        description="Fits and solves a scene on all ranks of MPI, by PETSc.",
        epilog="Options that are not listed go to PETSc, such as -log_view or -pc_gamg_threshold 0.02.",
    )
    parser.add_argument("scene", type=Path, help="a scene file")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="a key of the scene with another value")
    parser.add_argument("--out", type=Path, help="a folder that all ranks see: report.json and the springs of each rank and fit, for springfit merge")
    parser.add_argument("--partitioner", choices=PARTITIONERS, help="who shares out the points; the first of these that PETSc has")
    parser.add_argument("--json", action="store_true", help="print one JSON document in place of the table")
    return parser.parse_known_args(given)


def setting(text: str) -> "tuple[str, object]":
    """A key and its value, which is a text if it is no other value."""
    key, equals, value = text.partition("=")
    if not equals:
        raise ValueError(f"--set: expected KEY=VALUE, found {text}")
    try:
        return key.strip(), json.loads(value)
    except json.JSONDecodeError:
        return key.strip(), value.strip()


def make(folder: Path) -> None:
    """Makes the folder of the outputs.

    Raises:
        SpringfitError: A file is in its place, or the folder above is read-only.
    """
    from .._arguments import failure

    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise failure("--out", "a folder that can be written", str(error)) from error


def table(report: dict) -> str:
    """The errors of each fit, and the times."""
    head = f"{report['scene']}: {report['nodes']} points, {report['elements']} elements on {report['ranks']} ranks, shared out by {report['partitioner']}\n\n"
    width = max(len(fit["name"]) for fit in report["fits"]) if report["fits"] else 3
    lines = [f" {'fit':{width}}  {'load':12}  {'e_rms %':>9}  {'e_max %':>9}  iterations"]
    number = lambda value: "-" if value is None else f"{value:.4f}"
    for load in report["loads"]:
        lines.append(f" {'finite elements':{width}}  {load['name']:12}  {'':9}  {'':9}  {load['iterations']}")
    for fit in report["fits"]:
        for load in fit["loads"]:
            mark = "!" if load["indefinite"] else ""
            lines.append(
                f" {fit['name']:{width}}  {load['name']:12}  {number(load['e_rms']):>9}  {number(load['e_max']):>9}  {load['iterations']}{mark}"
            )
    if any(load["indefinite"] for fit in report["fits"] for load in fit["loads"]):
        lines.append("\n! the network is indefinite with these supports: some motion releases energy")
    times = "\n".join(f" {stage:30} {seconds:8.2f} s" for stage, seconds in report["seconds"].items())
    memory = ", ".join(f"{count / 1e9:.2f}" for count in report["bytes"])
    return head + "\n".join(lines) + f"\n\n{times}\n memory of each rank at most: {memory} GB"


def main(given: "list[str]") -> int:
    """The exit code: 0, or 2 where an input is wrong; the same on all ranks."""
    try:
        import petsc4py
        from mpi4py import MPI
    except ImportError as error:
        print(f"springfit.petsc: {error}: {MISSING}", file=sys.stderr)
        return 2
    comm = MPI.COMM_WORLD
    try:
        # Help and faults of arguments are the same on all ranks: one prints them.
        stream = None if comm.rank == 0 else open(os.devnull, "w")
        if stream is not None:
            sys.stderr = sys.stdout = stream
        options, rest = arguments(given)
        try:
            settings = dict(map(setting, options.set))
        except ValueError as fault:
            print(f"springfit.petsc: {fault}", file=sys.stderr)
            return 2
        petsc4py.init([sys.argv[0], *rest])
        from .ranks import Ended, together
        from .run import run

        try:
            if options.out is not None:
                together(comm, lambda: make(options.out))
            report = run(comm, options.scene, settings, options.out, options.partitioner)
            if options.out is not None and comm.rank == 0:
                partial = options.out / "report.json.partial"
                partial.write_text(json.dumps(report, indent=1) + "\n")
                partial.replace(options.out / "report.json")
        except Ended as fault:
            print(f"springfit.petsc: {fault}", file=sys.stderr)
            return 2
        print(json.dumps(report, indent=1) if options.json else table(report), flush=True)
        return 0
    except SystemExit:
        raise
    except BaseException:
        # Others wait for this rank and would wait for ever.
        if sys.__stderr__ is not None:
            print(f"springfit.petsc: rank {comm.rank} of {comm.size} failed:", file=sys.__stderr__)
            traceback.print_exc(file=sys.__stderr__)
            sys.__stderr__.flush()
        comm.Abort(1)
        return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

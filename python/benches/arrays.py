"""A million tetrahedra from NumPy arrays to arrays, beside the Rust call on the same arrays: python arrays.py [--runs 7] [--cells 55].

Runs of both alternate, and processor time is counted, so that other work of the machine does not matter. The Rust call is
``cargo bench --bench arrays``, which must be compiled with the same settings as the module.
"""

import argparse
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
import springfit as sf

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("--runs", type=int, default=7, help="of each")
parser.add_argument("--cells", type=int, default=55, help="along each side; six times as many tetrahedra")
options = parser.parse_args()

box = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[options.cells] * 3)
points = box.points + 0.1 / options.cells * np.random.default_rng(1).uniform(-1, 1, box.points.shape)
cells = box.cells["tet4"]


young = np.random.default_rng(2).uniform(1e3, 1e5, len(cells))


def python(young=1e4, objective="offdiag"):
    start = time.process_time()
    net = sf.fit(sf.Mesh(points, {"tet4": cells}), sf.Material(young, 0.3), objective)
    springs, constants, rest = net.springs, net.constants, net.rest
    return time.process_time() - start, constants, springs, rest


with tempfile.TemporaryDirectory() as folder:
    points.astype("<f8").tofile(Path(folder, "points.f64"))
    cells.astype("<i8").tofile(Path(folder, "cells.i64"))
    command = ["cargo", "bench", "-q", "--bench", "arrays", "--", folder]
    root = Path(__file__).resolve().parents[2]
    rust = subprocess.Popen(command, cwd=root, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    ours, theirs = [], []
    # The first of each warms up.
    for _ in range(options.runs + 1):
        seconds, constants, springs, rest = python()
        ours.append(seconds)
        rust.stdin.write("\n")
        rust.stdin.flush()
        seconds, total, count = rust.stdout.readline().split()
        theirs.append(float(seconds))
        assert int(count) == len(springs) == len(rest)
        assert abs(float(total) - constants.sum()) <= 1e-9 * abs(constants).sum()
    rust.stdin.close()
    rust.wait()
for objective in ("offdiag", "exact"):
    # One beside the other, so that both see the same machine.
    pairs = np.array([[python(given, objective)[0] for given in (1e4, young)] for _ in range(options.runs + 1)])[1:]
    (uniform, by_cell), ratio = np.median(pairs, axis=0), np.median(pairs[:, 1] / pairs[:, 0])
    print(f"{objective}: one modulus {uniform:.2f} s, a modulus of each cell {by_cell:.2f} s, ratio {ratio:.3f} in the middle")
ours, theirs = np.array(ours[1:]), np.array(theirs[1:])
print(f"{len(cells)} tetrahedra, {len(springs)} springs, {options.runs} runs of each")
for name, seconds in (("python", ours), ("rust", theirs)):
    print(f"{name:6} {np.median(seconds):.2f} s of the processor in the middle, {seconds.min():.2f} at least")
print(f"python / rust {np.median(ours / theirs):.2f} in the middle, {ours.min() / theirs.min():.2f} at least")

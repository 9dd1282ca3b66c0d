"""Moves a body whose stress relaxes, from network.npz beside this file, in explicit steps.

An exact network of tetrahedra whose shear relaxes has branches of springs whose constants relax towards those of the present shape; springs
that do not pull at rest and relax alike in shear and bulk have a dashpot in series.

    python run.py --time 0.3 --step 2e-4
"""

import argparse
import sys
from pathlib import Path

import numpy as np
from memory import Memory

options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
options.add_argument("--time", type=float, default=1.0, help="s")
options.add_argument("--step", type=float, help="s; the default is half of the longest stable one")
given = options.parse_args()

net = np.load(Path(__file__).with_name("network.npz"))
x, springs, volumes, rest, mass = net["points"].copy(), net["springs"], net["volumes"], net["rest"], net["masses"][:, None]
is_exact = len(volumes) and volumes.shape[1] == 4 and len(volumes) == len(net["tets"]) and not np.any(rest)
is_slack = np.allclose(rest, np.linalg.norm(x[springs[:, 1]] - x[springs[:, 0]], axis=1), rtol=1e-9, atol=0)
is_alike = np.array_equal(net["relaxation_shear"], net["relaxation_bulk"])
for holds, problem in [
    (x.shape[1] == 3, "a body in the plane"),
    (is_exact and not np.any(net["relaxation_bulk"]) or is_slack and is_alike and not is_exact, "springs or shares of another kind"),
    (not np.any(net["relaxation_yield"]), "a yield stress"),
    (np.all(np.isnan(net["relaxation_region"])), "regions that relax unlike"),
    (len(mass) == len(x), "no masses"),
]:
    if not holds:
        sys.exit(f"this loop serves exact networks of tetrahedra whose shear relaxes, and springs without tension at rest whose shear and bulk relax alike; found {problem}")
h = given.step or 0.5 * float(net["dt_max"])
if not h > 0:
    sys.exit(f"expected --step above 0 s, found {h}")


memory = Memory(net, h)


def pulled(f, ends, constants, x, rests):
    """Adds the forces of springs between two points."""
    along = x[ends[:, 1]] - x[ends[:, 0]]
    # A rest length of zero needs no direction.
    length = np.where(rests == 0, 1, np.linalg.norm(along, axis=1))
    pull = (constants * (1 - rests / length))[:, None] * along
    np.add.at(f, ends[:, 0], pull)
    np.add.at(f, ends[:, 1], -pull)


def forces(x):
    """The forces at the end of a step, after which the body has relaxed."""
    longer, larger, constants = memory.step(x)
    f = np.zeros_like(x)
    pulled(f, springs, memory.k, x, rest + longer)
    pulled(f, memory.edges, constants, x, np.zeros(len(constants)))
    if len(volumes):
        n, v = memory.shape(x)
        pull = memory.k_volume * (v - memory.rest_volume - larger) * v
        np.add.at(f, volumes, -pull[:, None, None] * n)
    return f


held, start, v, f = ~np.isnan(net["held"]), x.copy(), np.zeros_like(x), np.zeros_like(x)
for _ in range(round(given.time / h)):
    v = np.where(held, 0, v + h * (f / mass + net["gravity"]))
    x = x + h * v
    if len(volumes) and not np.all(memory.shape(x)[1] > 0):
        sys.exit("a cell is inside out")
    f = forces(x)
if not np.all(np.isfinite(x)):
    sys.exit("the motion has diverged")
np.save(Path(__file__).with_name("positions.npy"), x)
print(f"largest displacement {np.linalg.norm(x - start, axis=1).max():.6e} m after {given.time} s in steps of {h:.3e} s")

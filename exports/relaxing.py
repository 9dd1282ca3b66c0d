"""Moves a body whose stress relaxes, from network.npz beside this file: an exact network of tetrahedra in explicit steps.

Each term is a branch of springs of rest length zero whose constants relax towards those of the present shape. In the coordinates of a cell its
state is S, and a step with e = exp(-h/tau) and gamma = (1 - e) tau/h has the stress of S and of a content with the factor gamma, and then
S <- e S + gamma (1 - e) H, with H = J^(2/3) n_l.n_m/det^2. Theory: page "Springs that forget" of the book of springfit.

    python run.py --time 0.3 --step 2e-4
"""

import argparse
import sys
from pathlib import Path

import numpy as np

options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
options.add_argument("--time", type=float, default=1.0, help="s")
options.add_argument("--step", type=float, help="s; the default is half of the longest stable one")
given = options.parse_args()

net = np.load(Path(__file__).with_name("network.npz"))
x, springs, volumes = net["points"].copy(), net["springs"], net["volumes"]
shares, times, mass = net["relaxation_shear"], net["relaxation_time"], net["masses"][:, None]
for holds, problem in [
    (volumes.size and volumes.shape[1] == 4 and len(volumes) == len(net["tets"]), "cells that are not tetrahedra with a spring each"),
    (not np.any(net["rest"]), "springs with rest lengths"),
    (not np.any(net["relaxation_bulk"]), "shares of bulk"),
    (not np.any(net["relaxation_yield"]), "a yield stress"),
    (np.all(np.isnan(net["relaxation_region"])), "regions that relax unlike"),
    (len(mass) == len(x), "no masses"),
]:
    if not holds:
        sys.exit(f"this loop serves exact networks of tetrahedra whose shear relaxes alike; found {problem}")
h = given.step or 0.5 * float(net["dt_max"])
if not h > 0:
    sys.exit(f"expected --step above 0 s, found {h}")


def shape(x):
    """The edges of the tetrahedra from their first corners, the gradients of six times their volumes, and their volumes."""
    e = x[volumes[:, 1:]] - x[volumes[:, :1]]
    n = np.cross(np.roll(e, -1, 1), np.roll(e, -2, 1))
    return e, n, np.einsum("ck,ck->c", e[:, 0], n[:, 0]) / 6


# A spring on a content at rest has k (rest - V) = mu and k V = lambda + mu. What is left of mu is beside the same bulk modulus.
left = 1 - shares.sum()
v0 = shape(x)[2]
mu = net["k_volume"] * (net["rest_volume"] - v0)
bulk = net["k_volume"] * v0 - mu / 3
k = (bulk + left * mu / 3) / v0
rest = v0 + left * mu / k


def target(n, v):
    """mu V0 H: the constants of springs that have relaxed."""
    return np.einsum("c,clk,cmk->clm", mu * v0 * (v / v0) ** (2 / 3) / (6 * v) ** 2, n, n)


decay = np.exp(-h / times)
mean = -np.expm1(-h / times) * times / h
branches = [g * m * target(*shape(x)[1:]) for g, m in zip(shares, mean)]


def forces(x):
    """The forces at the end of a step, after which the branches have relaxed."""
    e, n, v = shape(x)
    pull = left * net["k"][:, None] * (x[springs[:, 1]] - x[springs[:, 0]])
    f = np.zeros_like(x)
    np.add.at(f, springs[:, 0], pull)
    np.add.at(f, springs[:, 1], -pull)
    push = -k * (v - rest) + shares @ mean * mu * v0 * (v / v0) ** (2 / 3) / v
    own = push[:, None, None] * n / 6 - sum(branches) @ e
    for corner in range(3):
        np.add.at(f, volumes[:, corner + 1], own[:, corner])
        np.add.at(f, volumes[:, 0], -own[:, corner])
    for i, now in enumerate(branches):
        branches[i] = decay[i] * now + shares[i] * mean[i] * (1 - decay[i]) * target(n, v)
    return f


held, start, v, f = ~np.isnan(net["held"]), x.copy(), np.zeros_like(x), np.zeros_like(x)
for _ in range(round(given.time / h)):
    v = np.where(held, 0, v + h * (f / mass + net["gravity"]))
    x = x + h * v
    if not np.all(shape(x)[2] > 0):
        sys.exit("a cell is inside out")
    f = forces(x)
np.save(Path(__file__).with_name("positions.npy"), x)
print(f"largest displacement {np.linalg.norm(x - start, axis=1).max():.6e} m after {given.time} s in steps of {h:.3e} s")

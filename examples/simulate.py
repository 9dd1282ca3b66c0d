"""Moves a network of springfit by the formulas of its reference alone, and compares the motion with that of springfit.

    springfit run exports/cube.toml
    python examples/simulate.py out/cube/exact.json out/cube/motion-exact.csv
"""
import csv
import json
import sys

import numpy as np

net, rows = json.load(open(sys.argv[1])), list(csv.DictReader(open(sys.argv[2])))
x, mass = np.array(net["points"]), np.array(net["masses"])[:, None]
start, v, step = x.copy(), np.zeros_like(x), net["motion"]["step"]
free = np.ones_like(x)
for held in net["held"]:
    free[held["point"]] = [u is None for u in held["displacement"]]
alike = {}  # springs with the same measure
for spring in net["springs"]:
    alike.setdefault(spring["measure"], []).append(spring)
column = lambda springs, key: np.array([spring[key] for spring in springs])
alike = [(net["measures"][m], *(column(s, key) for key in ["points", "constant", "rest", "damper"])) for m, s in alike.items()]


def length(x):
    edge = x[:, 1] - x[:, 0]
    c = np.linalg.norm(edge, axis=1)
    return c, np.stack([-edge, edge], axis=1) / c[:, None, None]


def content(measure, x):
    c, slope = 0.0, np.zeros_like(x)
    for cell in measure["cells"]:
        for term in measure["terms"]:
            f = np.einsum("sak,al->skl", x[:, cell["nodes"]], term["gradients"])
            det = cell["share"] * term["weight"] * np.linalg.det(f)
            c, cofactor = c + det, det[:, None, None] * np.linalg.inv(f)
            slope[:, cell["nodes"]] += np.einsum("slk,al->sak", cofactor, term["gradients"])
    return c, slope


def forces(x, v):
    force, energy = mass * (net["gravity"] or 0.0), 0.0
    for measure, points, constant, rest, damper in alike:
        c, slope = length(x[points]) if measure["kind"] == "length" else content(measure, x[points])
        pull = constant * (c - rest) + damper * np.einsum("sak,sak->s", slope, v[points])
        np.subtract.at(force, points, pull[:, None, None] * slope)
        energy += np.sum(constant * (c - rest) ** 2) / 2
    return force, energy


force, at_rest = forces(x, v)
energy = at_rest
# The elastic energy is beyond that at rest, where exact networks have tension. It is compared with the largest of the motion; the
# second term allows the rounding error of the energy at rest, 1e-14 of it.
stored = max(float(row["elastic"]) for row in rows) + 1e-5 * abs(at_rest)
worst = done = 0
for row in rows:
    for _ in range(round(float(row["t"]) / step) - done):
        v += step * free * force / mass
        x += step * v
        force, energy = forces(x, v)
        done += 1
    watched = (x - start)[net["motion"]["watched"]].mean(axis=0)
    found = [np.sum(mass * v**2) / 2, energy - at_rest, *np.sum(mass * v, axis=0), *watched]
    stated = np.array([float(row[name]) for name in ["kinetic", "elastic", "px", "py", "pz", "ux", "uy", "uz"]])
    size = np.array([stated[0], stored, *[np.abs(stated[2:5]).max()] * 3, *[np.abs(stated[5:]).max()] * 3])
    worst = max(worst, np.max(np.abs(found - stated) / np.where(size > 0, size, 1)))
print(f"{done} steps, {len(rows)} states: the largest relative difference is {worst:.1e}")
sys.exit(int(worst > 1e-9))

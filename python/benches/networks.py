"""What a network costs in Python: python networks.py [--cells 55] [--law 2] [--energy 8].

A fit and the matrices of a million tetrahedra with their memory, a law of force and an energy that are functions beside the same expressions, and one
factor for many loads. Times are of the processor.
"""

import argparse
import resource
import time

import numpy as np
import springfit as sf

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("--cells", type=int, default=55, help="along each side of the large cube; six times as many tetrahedra")
parser.add_argument("--law", type=int, default=2, help="cells along each side of the cube that is fitted with a law of force")
parser.add_argument("--energy", type=int, default=8, help="cells along each side of the cube that is fitted to an energy")
options = parser.parse_args()

MATERIAL = sf.Material(young=1e4, poisson=0.3)
LAMBDA, MU = 1e4 * 0.3 / (1.3 * 0.4), 1e4 / 2.6


def cube(n):
    """Tetrahedra of which no two are alike."""
    box = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[n] * 3)
    points = box.points + 0.1 / n * np.random.default_rng(1).uniform(-1, 1, box.points.shape)
    return sf.Mesh(points, {"tet4": box.cells[0][1]}, box.groups)


def timed(call):
    start = time.process_time()
    found = call()
    return time.process_time() - start, found


def told(what, seconds, more=""):
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    print(f"{what:44} {seconds:8.2f} s, at most {peak:.2f} GB so far{more}", flush=True)


def force(s, k, a):
    return k * (np.exp(a * s) - 1)


def energy(f):
    j = np.linalg.det(f)
    return MU / 2 * (np.einsum("nij,nij->n", f, f) - 3) - MU * np.log(j) + LAMBDA / 2 * np.log(j) ** 2


def stress(f):
    inverse = np.linalg.inv(f).transpose(0, 2, 1)
    return MU * (f - inverse) + LAMBDA * np.log(np.linalg.det(f))[:, None, None] * inverse


# SciPy is imported where the first matrix is made.
import scipy.sparse  # noqa: E402, F401

mesh = cube(options.cells)
count = len(mesh.cells[0][1])
seconds, net = timed(lambda: sf.fit(mesh, MATERIAL))
told(f"fit of {count} tetrahedra", seconds)
seconds, matrix = timed(net.stiffness)
told("net.stiffness()", seconds, f", {matrix.nnz} entries with places of {8 * matrix.indices.itemsize} bits")
told("net.forces(x)", timed(lambda: net.forces(1.01 * net.points))[0])
told("sf.stiffness(mesh, material)", timed(lambda: sf.stiffness(mesh, MATERIAL))[0])
del net, matrix

mesh = cube(options.law)
keys = dict(springs=["edge"], bounds={"a": [0.1, 10]})
for name, law in (("an expression", "k*(exp(a*s) - 1)"), ("a function", force)):
    seconds, _ = timed(lambda: sf.sampled(mesh, MATERIAL, "neo-hookean", force=law, **keys))
    told(f"{len(mesh.cells[0][1])} tetrahedra, the law {name}", seconds)

mesh = cube(options.energy)
for name, keys in (("an expression", {"law": "neo-hookean"}), ("P(F)", {"stress": stress}), ("W(F)", {"law": energy})):
    seconds, _ = timed(lambda: sf.sampled(mesh, MATERIAL, springs=["edge"], **keys))
    told(f"{len(mesh.cells[0][1])} tetrahedra, the energy {name}", seconds)

net = sf.fit(cube(16), MATERIAL)
fix = net.points[:, 2] < 0.01
loads = np.random.default_rng(2).uniform(-1e-3, 1e-3, (10, *net.points.shape))
seconds, solve = timed(lambda: net.factorized(fix))
told(f"a factor of {net.points.size} unknowns", seconds)
told("ten loads by it", timed(lambda: solve(loads))[0])

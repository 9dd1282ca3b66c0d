"""Bodies moved by XPBD as it was published, in NumPy: no program, but what programs that use it can reach.

Macklin, Mueller and Chentanez, XPBD: Position-Based Simulation of Compliant Constrained Dynamics, Motion in Games 2016. A constraint C of
compliance a changes its multiplier by dl = -(C + a' l)/(grad C M^-1 grad C + a'), a' = a/h^2, and the positions by M^-1 grad C dl. Springs
are C = length - rest with a = 1/k, springs on volumes C = V - V0 with a = 1/K. Elements of our own are the six Green strains of a
tetrahedron at once, with the inverse of V D as their compliance: the law of St. Venant and Kirchhoff. Constraints of one colour share no
point and move together, colour after colour, as Gauss and Seidel do. A short step with one pass is the variant of Macklin et al., Small
Steps in Physics Simulation, SCA 2019.
"""
import math
import re

import numpy as np

version = np.__version__


class Constraints:
    """Constraints of one kind in colours: `value` gives C [n, m] and its gradients [n, 3 corners, m] from corners [n, corners, 3]."""

    def __init__(self, corners, compliance, value, *data):
        self.value, self.colours = value, []
        colour = np.zeros(len(corners), int)
        taken = {}
        for c, points in enumerate(corners.tolist()):
            used = set().union(*(taken.setdefault(p, set()) for p in points))
            colour[c] = next(n for n in range(len(used) + 1) if n not in used)
            for p in points:
                taken[p].add(colour[c])
        for n in range(colour.max(initial=-1) + 1):
            chosen = colour == n
            self.colours.append((corners[chosen], compliance[chosen], [d[chosen] for d in data]))

    def start(self):
        self.multipliers = [np.zeros((*a.shape[:2], 1)) for _, a, _ in self.colours]

    def project(self, x, inverse_mass, h):
        for (corners, compliance, data), multiplier in zip(self.colours, self.multipliers):
            c, slopes = self.value(x[corners], *data)
            weights = np.repeat(inverse_mass[corners], 3, axis=1)[:, :, None]
            scaled = compliance / h**2
            matrix = slopes.transpose(0, 2, 1) @ (weights * slopes) + scaled
            left = -c[:, :, None] - scaled @ multiplier
            change = np.linalg.solve(matrix, left) if c.shape[1] > 1 else left / matrix
            multiplier += change
            x[corners] += (weights * (slopes @ change)).reshape(*corners.shape, 3)


def lengths(x, rest):
    along = x[:, 1] - x[:, 0]
    length = np.linalg.norm(along, axis=1)
    slope = along / length[:, None]
    return (length - rest)[:, None], np.concatenate([-slope, slope], axis=1)[:, :, None]


def volumes(x, rest):
    edges = (x[:, 1:] - x[:, :1]).transpose(0, 2, 1)
    volume = np.linalg.det(edges) / 6
    slopes = volume[:, None, None] * np.linalg.inv(edges)
    slopes = np.concatenate([-slopes.sum(1, keepdims=True), slopes], axis=1)
    return (volume - rest)[:, None], slopes.reshape(-1, 12, 1)


# The strains by their axes, with the shears doubled.
I, J = np.array([0, 1, 2, 1, 0, 0]), np.array([0, 1, 2, 2, 2, 1])
HALF = np.array([0.5, 0.5, 0.5, 1.0, 1.0, 1.0])
UNIT = (I == J).astype(float)


def strains(x, inverse):
    """Green's strains of tetrahedra. Rows of `inverse` are the gradients of the shape functions 1 to 3."""
    deformation = (x[:, 1:] - x[:, :1]).transpose(0, 2, 1) @ inverse
    metric = deformation.transpose(0, 2, 1) @ deformation
    shape_i, shape_j = inverse[:, :, I][:, :, None], inverse[:, :, J][:, :, None]
    along_i, along_j = deformation[:, :, I][:, None], deformation[:, :, J][:, None]
    slopes = HALF * (shape_i * along_j + shape_j * along_i)
    slopes = np.concatenate([-slopes.sum(1, keepdims=True), slopes], axis=1)
    return HALF * (metric[:, I, J] - UNIT), slopes.reshape(-1, 12, 6)


def hooke(young, poisson):
    mu, lam = young / (2 + 2 * poisson), young * poisson / ((1 + poisson) * (1 - 2 * poisson))
    matrix = np.diag([2 * mu] * 3 + [mu] * 3)
    matrix[:3, :3] += lam
    return matrix


class Body:
    def __init__(self, folder, solver, told, damping):
        net = np.load(folder / "network.npz")
        self.points = net["points"]
        self.inverse_mass = 1 / net["masses"]
        self.inverse_mass[net["fixed"]] = 0
        milliseconds, self.passes = re.match(r"([0-9.]+) ms, (\d+) pass", solver).groups()
        self.step, self.passes = 1e-3 * float(milliseconds), int(self.passes)
        self.factor = math.exp(-damping * self.step)
        if told:
            tets = net["tets"]
            edges = (self.points[tets[:, 1:]] - self.points[tets[:, :1]]).transpose(0, 2, 1)
            compliance = np.linalg.inv(hooke(*told)) / (np.linalg.det(edges) / 6)[:, None, None]
            self.kinds = [Constraints(tets, compliance, strains, np.linalg.inv(edges))]
        else:
            one = lambda k: (1 / k)[:, None, None]
            self.kinds = [Constraints(net["springs"], one(net["k"]), lengths, net["rest"])]
            if len(net["volumes"]):
                self.kinds.append(Constraints(net["volumes"], one(net["k_volume"]), volumes, net["rest_volume"]))

    def load(self, forces):
        self.x, self.v = self.points.copy(), np.zeros_like(self.points)
        self.acceleration = self.inverse_mass[:, None] * forces

    def advance(self, steps):
        h = self.step
        with np.errstate(all="ignore"):
            for _ in range(steps):
                before = self.x
                self.x = before + h * (self.v + h * self.acceleration)
                self.x[self.inverse_mass == 0] = before[self.inverse_mass == 0]
                for kind in self.kinds:
                    kind.start()
                for _ in range(self.passes):
                    for kind in self.kinds:
                        kind.project(self.x, self.inverse_mass, h)
                self.v = self.factor * (self.x - before) / h
                if not np.all(np.isfinite(self.v)):
                    return

    def positions(self):
        return self.x

    def warnings(self):
        """None: there is no program that warns."""
        return []

"""Where a springfit network rests, from its JSON file alone, by Newton's method (numpy).

An independent reference for tests: energies, forces and tangents are those that the reference of outputs states.
"""
import json

import numpy as np


def read(path):
    with open(path) as file:
        return json.load(file)


def simplices(net):
    """Springs on lengths, and on contents of simplices: points, constants, rest measures."""
    lengths = [s for s in net["springs"] if net["measures"][s["measure"]]["kind"] == "length"]
    contents = [s for s in net["springs"] if net["measures"][s["measure"]]["kind"] == "content"]
    assert all(s["law"] is None for s in net["springs"]) and len(lengths) + len(contents) == len(net["springs"])

    def columns(springs):
        return (np.array([s["points"] for s in springs], int), *(np.array([s[key] for s in springs]) for key in ["constant", "rest"]))

    return columns(lengths), columns(contents)


def forces_and_tangent(net, x):
    """The gradient of the energy and its derivative, [points, d] and [points d, points d]."""
    (ends, k, rest), (corners, constants, rests) = simplices(net)
    n, d = x.shape
    force, tangent = np.zeros((n, d)), np.zeros((n, d, n, d))
    for (i, j), k, rest in zip(ends, k, rest):
        r = x[j] - x[i]
        length = np.linalg.norm(r)
        pull = k * (1 - rest / length) if rest else k
        block = pull * np.eye(d) + ((k - pull) / length**2 * np.outer(r, r) if rest else 0)
        force[i] -= pull * r
        force[j] += pull * r
        for a, b, sign in [(i, i, 1), (j, j, 1), (i, j, -1), (j, i, -1)]:
            tangent[a, :, b, :] += sign * block
    for points, k, rest in zip(corners, constants, rests):
        edges = (x[points[1:]] - x[points[0]]).T
        factorial = [1, 1, 2, 6][d]
        content = np.linalg.det(edges) / factorial
        inverse = np.linalg.inv(edges)
        slopes = content * inverse  # dV/dx of the corners but the first
        slopes = np.vstack([-slopes.sum(0), slopes])
        inner = inverse[:, None, :, None] * inverse[None, :, None, :]  # g_a,i g_b,j
        bend = content * (inner - inner.transpose(1, 0, 2, 3))
        whole = np.zeros((d + 1, d + 1, d, d))
        whole[1:, 1:] = bend
        whole[0, 1:] = -bend.sum(0)
        whole[1:, 0] = -bend.sum(1)
        whole[0, 0] = bend.sum((0, 1))
        tension = k * (content - rest)
        for a, p in enumerate(points):
            force[p] += tension * slopes[a]
            for b, q in enumerate(points):
                tangent[p, :, q, :] += k * np.outer(slopes[a], slopes[b]) + tension * whole[a, b]
    return force, tangent.reshape(n * d, n * d)


def rest_under_gravity(net, gravity, load=None, steps=1):
    """Positions at rest, [points, d], under gravity and the load of this name in so many steps; the residual is at rounding."""
    x = np.array(net["points"])
    n, d = x.shape
    held = np.zeros((n, d), bool)
    for support in net["held"]:
        held[support["point"]] = [u is not None for u in support["displacement"]]
    weight = np.array(net["masses"])[:, None] * np.array(gravity)
    for own in next(own["forces"] for own in net["loads"] if own["name"] == load) if load else []:
        weight[own["point"]] += own["force"]
    free = np.flatnonzero(~held.ravel())
    for step in range(1, steps + 1):
        settle(net, x, step / steps * weight, free)
    return x


def settle(net, x, forces, free):
    """Moves the positions x to where they rest under these forces."""
    for _ in range(30):
        force, tangent = forces_and_tangent(net, x)
        left = (forces - force).ravel()[free]
        step = np.linalg.solve(tangent[np.ix_(free, free)], left)
        x.ravel()[free] += step
        if np.abs(step).max() < 1e-13 * np.ptp(x):
            return
    raise RuntimeError("no equilibrium was found")

"""Where a springfit network rests, from its JSON file alone, by Newton's method (numpy).

An independent reference for tests: energies, forces and tangents are those that the reference of outputs states.
"""
import json

import numpy as np


def read(path):
    with open(path) as file:
        return json.load(file)


def of_kind(net, kind):
    """The springs whose measure is of this kind."""
    return [s for s in net["springs"] if net["measures"][s["measure"]]["kind"] == kind]


def simplices(net):
    """Springs on lengths, and on contents of simplices: points, constants, rest measures."""
    lengths, contents = of_kind(net, "length"), of_kind(net, "content")
    assert all(s["law"] is None for s in net["springs"])
    assert len(lengths) + len(contents) + len(of_kind(net, "turn")) + len(of_kind(net, "expression")) == len(net["springs"])

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
    for spring in of_kind(net, "expression"):
        assert spring["kind"] == "area" and len(spring["points"]) == 3 and d == 3
        add(spring, spring["points"], area, x, force, tangent)
    for spring in of_kind(net, "turn"):
        (cell,) = net["measures"][spring["measure"]]["cells"]
        assert cell["share"] == 1
        add(spring, [spring["points"][place] for place in cell["nodes"]], turn, x, force, tangent)
    return force, tangent.reshape(n * d, n * d)


def area(x):
    """The area of a triangle in space and its gradient."""
    a, b, c = x
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal)
    slopes = [np.cross(opposite, normal / size) / 2 for opposite in (b - c, c - a, a - b)]
    return size / 2, np.array(slopes)


def turn(x):
    """The angle about an edge from the plane of a triangle to a point, and its gradient: both move at right angles to the way to the edge, by one over this
    way, and the ends of the edge against them."""
    apex, a, b, last = x
    length = np.linalg.norm(b - a)
    t = (b - a) / length
    away = [p - a - t * ((p - a) @ t) for p in (apex, last)]
    angle = np.arctan2(np.cross(-away[0], away[1]) @ -t, -away[0] @ away[1])
    slopes = [np.cross(side, v) / (v @ v) for side, v in zip((t, -t), away)]
    feet = [(p - a) @ t / length for p in (apex, last)]
    ends = [-sum((1 - f) * g for f, g in zip(feet, slopes)), -sum(f * g for f, g in zip(feet, slopes))]
    return angle, np.array([slopes[0], *ends, slopes[1]])


def add(spring, points, measured, x, force, tangent):
    """Adds a spring on what is measured of these points. Its second derivatives are differences."""
    y = x[points]
    h, n = 1e-6 * np.ptp(y), y.size
    value, slope = measured(y)
    moved = lambda unit: measured(y + h * unit.reshape(y.shape))[1].ravel()
    bend = np.array([(moved(unit) - moved(-unit)) / (2 * h) for unit in np.eye(n)])
    k, tension = spring["constant"], spring["constant"] * (value - spring["rest"])
    block = (k * np.outer(slope, slope) + tension * (bend + bend.T) / 2).reshape(*y.shape, *y.shape)
    for i, p in enumerate(points):
        force[p] += tension * slope[i]
        for j, q in enumerate(points):
            tangent[p, :, q, :] += block[i, :, j, :]


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
    last = np.inf
    for _ in range(30):
        force, tangent = forces_and_tangent(net, x)
        left = (forces - force).ravel()[free]
        step = np.linalg.solve(tangent[np.ix_(free, free)], left)
        x.ravel()[free] += step
        size = np.abs(step).max() / np.ptp(x)
        # A thin sheet is known less exactly than its stiff membrane lets forces be: steps end at rounding errors.
        if size < 1e-13 or last < 1e-9 and size >= last / 2:
            return
        last = size
    raise RuntimeError("no equilibrium was found")

"""Scores a network of springs against the reference displacements of a body (numpy and scipy alone).

    python score.py BODY NETWORK.json                         a table
    python score.py BODY NETWORK.json --row METHOD --json     a row for a file in results/

BODY is a name in reference/, or a file as those there are. NETWORK.json is a network file of springfit (`springfit fit -o x.json`,
`springfit schema network`); of it are read `dimension`, `points`, `springs` and `measures`, so that other programs write one easily. Springs
on lengths and on contents are known. Points are matched by place, in any order; points that the body does not have are free.

The network is linear: K = Σ k g gᵀ + k (c - c0) H, with the gradient g and the second derivative H of the measure c at rest. The
points that the body holds do not move, and K u = f. Nothing here is springfit's.
"""
import argparse
import json
import sys
from pathlib import Path

import numpy as np
from scipy.linalg import LinAlgError, cholesky
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu
from scipy.spatial import cKDTree

FOLDER = Path(__file__).resolve().parent
# A point is that of the body if it is no farther, as a share of the extent.
SAME_PLACE = 1e-9
# Larger residuals, as a share of the load, and larger forces at rest are faults of the network.
BALANCED = 1e-6
LEVI_CIVITA = np.zeros((3, 3, 3))
for i, j, k in [(0, 1, 2), (1, 2, 0), (2, 0, 1)]:
    LEVI_CIVITA[i, j, k], LEVI_CIVITA[j, i, k] = 1, -1


class Fault(Exception):
    """What is wrong with an input."""


def lengths(x, springs):
    """Of springs between two points: c, g [springs, 2, d] and H [springs, 2, d, 2, d]. Where the rest length is zero, c is |r| as well."""
    pairs = np.array([spring["points"] for spring in springs])
    rest = np.array([spring["rest"] for spring in springs])
    r = x[pairs[:, 1]] - x[pairs[:, 0]]
    length = np.linalg.norm(r, axis=1)
    if (length == 0).any():
        raise Fault(f"springs: points {pairs[length == 0][0].tolist()} of a spring are at one place")
    n = r / length[:, None]
    signs = np.array([-1.0, 1.0])
    gradient = signs[None, :, None] * n[:, None, :]
    across = (np.eye(x.shape[1]) - n[:, :, None] * n[:, None, :]) / length[:, None, None]
    second = np.einsum("a,b,sij->saibj", signs, signs, across)
    return pairs, length - rest, gradient, second


def contents(x, springs, measure):
    """Of springs on c = Σ share |Σ w det(Σ x_a ⊗ G_a)|, as :func:`lengths`."""
    d = x.shape[1]
    nodes = np.array([spring["points"] for spring in springs])
    rest = np.array([spring["rest"] for spring in springs])
    content, gradient = np.zeros(len(nodes)), np.zeros((*nodes.shape, d))
    second = np.zeros((len(nodes), nodes.shape[1], d, nodes.shape[1], d))
    for cell in measure["cells"]:
        places = np.array(cell["nodes"])
        value, first, bend = 0.0, 0.0, 0.0
        for term in measure["terms"]:
            G = np.array(term["gradients"])
            if G.shape != (len(places), d):
                raise Fault(f"measures: gradients of shape {G.shape}, expected {(len(places), d)}: contents of full dimension are known")
            J = np.einsum("sai,ak->sik", x[nodes[:, places]], G)
            if d == 3:
                cofactor = np.einsum("ijm,kln,sjl,smn->sik", LEVI_CIVITA, LEVI_CIVITA, J, J) / 2
                turn = np.einsum("ijm,kln,smn->sikjl", LEVI_CIVITA, LEVI_CIVITA, J)
            else:
                plane = LEVI_CIVITA[:2, :2, 2]
                cofactor = np.einsum("ij,kl,sjl->sik", plane, plane, J)
                turn = np.broadcast_to(np.einsum("ij,kl->ikjl", plane, plane), (len(J), 2, 2, 2, 2))
            value = value + term["weight"] * np.linalg.det(J)
            first = first + term["weight"] * np.einsum("sik,ak->sai", cofactor, G)
            bend = bend + term["weight"] * np.einsum("sikjl,ak,bl->saibj", turn, G, G)
        scale = np.sign(value) * cell["share"]
        content += scale * value
        gradient[:, places] += scale[:, None, None] * first
        second[np.ix_(np.arange(len(nodes)), places, np.arange(d), places, np.arange(d))] += scale[:, None, None, None, None] * bend
    return nodes, content - rest, gradient, second


def assemble(network):
    """The stiffness at rest, sparse [points d, points d], and the forces at rest, [points, d]."""
    x = np.array(network["points"], float)
    d = network["dimension"]
    if x.ndim != 2 or x.shape[1] != d or d not in (2, 3):
        raise Fault(f"points: shape {x.shape}, expected (points, dimension) with a dimension of 2 or 3")
    groups = {}
    for number, spring in enumerate(network["springs"]):
        if spring["law"] is not None:
            raise Fault(f"springs[{number}].law: expected null, found \"{spring['law']}\": linear springs are known")
        if not 0 <= min(spring["points"]) <= max(spring["points"]) < len(x):
            raise Fault(f"springs[{number}].points: expected places below {len(x)}, found {spring['points']}")
        groups.setdefault((spring["measure"], len(spring["points"])), []).append(spring)
    rows, columns, values, forces = [], [], [], np.zeros_like(x)
    for (place, _), springs in groups.items():
        measure = network["measures"][place]
        if measure["kind"] == "length":
            nodes, stretch, gradient, second = lengths(x, springs)
        elif measure["kind"] == "content":
            nodes, stretch, gradient, second = contents(x, springs, measure)
        else:
            raise Fault(f"measures[{place}].kind: expected \"length\" or \"content\", found \"{measure['kind']}\"")
        k = np.array([spring["constant"] for spring in springs])
        block = np.einsum("s,sai,sbj->saibj", k, gradient, gradient) + (k * stretch)[:, None, None, None, None] * second
        np.add.at(forces, nodes, -(k * stretch)[:, None, None] * gradient)
        freedoms = (nodes[:, :, None] * d + np.arange(d)).reshape(len(nodes), -1)
        rows.append(np.repeat(freedoms, freedoms.shape[1], axis=1).ravel())
        columns.append(np.tile(freedoms, (1, freedoms.shape[1])).ravel())
        values.append(block.ravel())
    if not values:
        raise Fault("springs: expected at least one, found none")
    size = x.size
    return coo_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), (size, size)).tocsc(), forces


def score(body, network):
    """The errors of a network, in percent, under each load of a body."""
    points, x = np.array(body["points"]), np.array(network["points"], float)
    if x.ndim != 2 or x.shape[1] != points.shape[1]:
        raise Fault(f"points: shape {x.shape}, expected {points.shape[1]} coordinates of each point")
    distance, place = cKDTree(x).query(points)
    extent = np.ptp(points, axis=0).max()
    far = np.flatnonzero(distance > SAME_PLACE * extent)
    if len(far):
        raise Fault(f"points: expected every point of the body, found {len(far)} missing, the first at {points[far[0]].tolist()} m")
    stiffness, at_rest = assemble(network)
    free = np.ones(x.shape, bool)
    free[place[body["held"]]] = False
    free = np.flatnonzero(free)
    inner = stiffness[np.ix_(free, free)].tocsc()
    try:
        cholesky(inner.toarray(), check_finite=True)
        definite = True
    except (LinAlgError, ValueError):
        definite = False
    try:
        solver = splu(inner)
    except RuntimeError:
        raise Fault("the network has a motion without stiffness: there are no displacements") from None
    loads = {}
    for load in body["loads"]:
        force = np.zeros(x.shape)
        force[place] = load["forces"]
        given = force.ravel()[free]
        if np.linalg.norm(at_rest.ravel()[free]) > BALANCED * np.linalg.norm(given):
            raise Fault("the network is not in balance at rest: its springs move it without a load")
        moved = np.zeros(x.size)
        moved[free] = solver.solve(given)
        if not np.linalg.norm(inner @ moved[free] - given) <= BALANCED * np.linalg.norm(given):
            raise Fault("the network has a motion with hardly any stiffness: there are no displacements")
        theirs, ours = np.array(load["displacement"]), moved.reshape(x.shape)[place]
        size = np.linalg.norm(theirs, axis=1)
        error = np.linalg.norm(ours - theirs, axis=1)
        work = [(force[place] * u).sum() for u in (ours, theirs)]
        # Rounding would decide between points that a symmetry of the body makes equal.
        at_tip = size >= (1 - 1e-6) * size.max()
        loads[load["name"]] = {
            "e_rms": 100 * np.sqrt((error**2).mean()) / size.max(),
            "e_max": 100 * error.max() / size.max(),
            "e_tip": 100 * error[at_tip].max() / size.max(),
            "e_energy": 100 * (work[0] / work[1] - 1),
        }
    constants = np.array([spring["constant"] for spring in network["springs"]])
    return {"springs": len(constants), "negative": int((constants < 0).sum()), "definite": definite, "loads": loads}


def read(path, wanted):
    """A JSON file of this format."""
    try:
        value = json.loads(Path(path).read_text())
    except (OSError, ValueError) as error:
        raise Fault(f"{path}: {error}") from None
    if not isinstance(value, dict) or value.get("format") != wanted:
        raise Fault(f"{path}: format: expected \"{wanted}\"")
    return value


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("body", help="a name in reference/, or a file as those there are")
    arguments.add_argument("network", help="a network file of springfit, or one of these keys")
    arguments.add_argument("--row", metavar="METHOD", default="", help="the name of the method in the row")
    arguments.add_argument("--json", action="store_true", help="print the row of a file in results/")
    options = arguments.parse_args()
    named = FOLDER / "reference" / f"{options.body}.json"
    path = named if named.exists() else Path(options.body)
    try:
        body = read(path, "springfit benchmark body")
        network = read(options.network, "springfit network")
        try:
            found = score(body, network)
        except KeyError as key:
            raise Fault(f"{options.network}: key {key} is missing") from None
        except Fault as fault:
            raise Fault(f"{options.network}: {fault}") from None
    except Fault as fault:
        print(f"error: {fault}", file=sys.stderr)
        sys.exit(2)
    if options.json:
        print(json.dumps({"body": path.stem, "method": options.row, **found}))
        return
    print(f"{body['title']}\n{found['springs']} springs, {found['negative']} of them negative; "
          f"{'positive definite' if found['definite'] else 'NOT positive definite'}\n")
    print(f"{'load':10} {'e_rms %':>10} {'e_max %':>10} {'e_tip %':>10} {'e_energy %':>10}")
    for name, errors in found["loads"].items():
        print(f"{name:10} " + " ".join(f"{errors[key]:10.4f}" for key in ("e_rms", "e_max", "e_tip", "e_energy")))


if __name__ == "__main__":
    main()

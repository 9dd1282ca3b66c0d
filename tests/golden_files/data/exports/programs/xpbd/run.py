# Beware: the constants are those of equations that are solved, and the body is softer where sweeps end early (xpbd, 10 substeps of 1/60 s with 1 sweep each, gauss-seidel, order colours): more substeps come closer, and a fit with an engine has constants that answer like the body at its settings.
# Beware: 17 of 412 cells are inside out at rest under gravity and the load "shear".
"""A springfit network moved by XPBD (Macklin, Müller and Chentanez 2016), in NumPy (pip install numpy): the twin of run.c.

    python run.py            two seconds of motion, then where the points are
    python run.py 5          five seconds
    python run.py --rest F   comes to rest and writes the positions to the file F, a line for each point
    python run.py --load N   any of these under the load N of the scene as well
    --substeps N, --iterations N, --step S   in place of the setting in network.json; --single counts in single precision

What was converted: a spring of constant k is a constraint of compliance 1/k on a length, an area, a volume or the angle of a hinge with
the rest measure of the spring. Where stress relaxes, a spring has dashpots in series, one for each term of the share g and the
time tau, which has lengthened by w: it pulls as k (C - sum of g w). Constraints that follow each other and share no point are corrected at once, which changes nothing.
"""
import argparse
import json
import sys
from pathlib import Path

import numpy as np


def dot(a, b):
    return np.sum(a * b, axis=-1, keepdims=True)


def turns(x):
    """The angles at the edges from x[:, 1] to x[:, 2] between the planes of triangles with the apexes x[:, 0] and other apexes x[:, 3], and their
    gradients; they are zero where both triangles are flat."""
    t, u, v = x[:, 2] - x[:, 1], x[:, 0] - x[:, 1], x[:, 3] - x[:, 1]
    length = np.sqrt(dot(t, t))
    feet = [dot(u, t) / length**2, dot(v, t) / length**2]
    n = np.cross(t, u)
    area = np.sqrt(dot(n, n))
    n, t = n / area, t / length
    m = np.cross(t, n)  # points out of the triangle
    out, up = dot(v, m), dot(v, n)
    first, last = n * length / area, (out * n - up * m) / (out**2 + up**2)
    start, end = (feet[0] - 1) * first + (feet[1] - 1) * last, -feet[0] * first - feet[1] * last
    return np.arctan2(up, out)[:, 0], np.stack([first, start, end, last], axis=1)


def measures(kind, x):
    """The measures of constraints of one kind, and the gradients at each of their points, [constraints, points, 3], from the places of these."""
    if kind == "hinge":
        return turns(x)
    e = (x[:, 1:] - x[:, :1]).swapaxes(0, 1)  # edges from the first point
    if len(e) == 1:  # a length
        length = np.linalg.norm(e[0], axis=1, keepdims=True)
        g = [np.divide(e[0], length, out=np.zeros_like(e[0]), where=length > 0)]
    elif len(e) == 2:  # an area, of which n is half the normal; in the plane along z
        n = np.cross(e[0], e[1]) if kind == "area" else np.broadcast_to(np.array([0, 0, 1], x.dtype), e[0].shape)
        length = np.linalg.norm(n, axis=1, keepdims=True)
        n = n / np.where(length > 0, 2 * length, 1)
        g = [np.cross(e[1], n), np.cross(n, e[0])]
    else:  # a volume
        g = [np.cross(e[1], e[2]) / 6, np.cross(e[2], e[0]) / 6, np.cross(e[0], e[1]) / 6]
    # Each measure grows in proportion to the first edge in its direction.
    return np.sum(g[0] * e[0], axis=1), np.stack([-sum(g), *g], axis=1)


class Body:
    def __init__(self, net, setting, forces, real, is_relaxed=False):
        self.h = real(setting["step"] / setting["substeps"])
        self.iterations, self.relaxation = setting["iterations"], real(setting["relaxation"])
        self.is_jacobi = setting["sweep"] == "jacobi"
        self.x = np.array(net["points"], real).reshape(-1, 3)
        self.v = np.zeros_like(self.x)
        self.w = np.repeat(1 / np.array(net["masses"], real)[:, None], 3, axis=1)  # zero where a point is held
        for point, axis in net["held"]:
            self.w[point, axis] = 0
        self.pull = np.where(self.w > 0, np.array(net["gravity"], real) + self.w * np.asarray(forces, real), 0)
        self.batches = list(batches(net["constraints"], real))
        self.share, time = np.array(net.get("relaxation", []), real).reshape(-1, 2).T
        if is_relaxed:
            self.left, self.share = 1 - self.share.sum(), self.share[:0]
            if not self.left > 1e-6:
                misuse('--rest: expected "a body of which some stress remains", found "one that relaxes wholly"')
        else:
            # The exponential rule: exact for stretches that change evenly over a substep. What relaxes in it makes springs softer.
            self.decay = np.exp(-self.h / time)
            self.mean = -np.expm1(-self.h / time) * time / self.h
            self.left = 1 - self.share @ (1 - self.mean)
        self.last = [np.zeros_like(rest) for *_, rest in self.batches]
        self.creep = [np.zeros((len(self.share), len(rest)), real) for *_, rest in self.batches]

    def substep(self):
        """Points fly under the forces, the sweeps correct where they are, and velocities follow from where they have come."""
        old = self.x.copy()
        self.v += self.h * self.pull
        self.x += self.h * self.v
        multipliers = [np.zeros_like(rest) for *_, rest in self.batches]
        # At the end of the substep w is what is kept here, and (1 - mean) C.
        kept = self.creep
        if len(self.share):
            kept = [self.decay[:, None] * w + np.outer(self.mean - self.decay, last) for w, last in zip(self.creep, self.last)]
        shifts = [self.share @ w / self.left for w in kept]
        for _ in range(self.iterations):
            self.sweep(multipliers, shifts)
        self.v = (self.x - old) / self.h
        if len(self.share):
            self.last = [measures(kind, self.x[points])[0] - rest for kind, points, _, rest in self.batches]
            self.creep = [w + np.outer(1 - self.mean, last) for w, last in zip(kept, self.last)]

    def sweep(self, multipliers, shifts):
        """Corrects each constraint once. Gauss-Seidel sees what the constraints before have moved, Jacobi the positions before the sweep."""
        x = self.x.copy() if self.is_jacobi else self.x
        for (kind, points, compliance, rest), multiplier, shift in zip(self.batches, multipliers, shifts):
            w = self.w[points]
            measure, g = measures(kind, x[points])
            violation = measure - rest - shift
            softness = compliance / (self.left * self.h**2)
            stiffness = np.sum(w * g * g, axis=(1, 2))
            # The step of Newton's method for violation + softness * multiplier = 0.
            step = -self.relaxation * (violation + softness * multiplier) / (stiffness + softness)
            multiplier += step
            self.x[points] += w * g * step[:, None, None]

    def energy(self, v):
        """The kinetic energy of the velocities v."""
        free = self.w > 0
        return float(np.sum(np.square(v[free], dtype=float) / self.w[free])) / 2

    def settle(self):
        """Comes to rest: whenever the kinetic energy has passed a maximum, the body is stopped. Returns the number of substeps."""
        highest = last = 0.0
        # Motions by a few last digits of each position in a substep.
        least = self.energy(4 * np.finfo(self.x.dtype).eps * self.x / self.h)
        for n in range(1, 2_000_001):
            self.substep()
            energy = self.energy(self.v)
            if not np.isfinite(energy):
                break
            if energy <= last:
                if last <= 1e-18 * highest + least:
                    return n
                self.v[:] = 0
                energy = 0.0
            last, highest = energy, max(highest, energy)
        sys.exit("the body has not come to rest")


def batches(constraints, real):
    """Kind, points, compliances and rest measures of constraints that follow each other, are of one kind, and share no point."""
    batch, used = [], set()
    form = lambda own: (own["kind"], len(own["points"]))
    for own in [*constraints, None]:
        if batch and (own is None or form(own) != form(batch[0]) or not used.isdisjoint(own["points"])):
            yield [batch[0]["kind"], np.array([c["points"] for c in batch]), *(np.array([c[key] for c in batch], real) for key in ["compliance", "rest"])]
            batch, used = [], set()
        if own:
            batch.append(own)
            used.update(own["points"])


def misuse(words):
    print(words, file=sys.stderr)
    sys.exit(2)


def read(path):
    try:
        net = json.loads(path.read_text())
    except (OSError, ValueError) as error:
        misuse(f"network.json: expected a file that can be read, found \"{error}\"; springfit export --to xpbd writes this file")
    found = [net.get(key) for key in ["format", "version"]] if isinstance(net, dict) else []
    if found != ["springfit xpbd", 1]:
        misuse(f"network.json: expected the format springfit xpbd of version 1, found {found}; springfit export --to xpbd writes this file")
    return net


def forces_of(net, name):
    """The forces [points, 3], N, of the load of this name."""
    forces = np.zeros((len(net["points"]), 3))
    if name is None:
        return forces
    load = next((load for load in net["loads"] if load["name"] == name), None)
    if load is None:
        names = " ".join(f'"{load["name"]}"' for load in net["loads"]) or "none"
        misuse(f'--load: expected one of {names}, found "{name}"')
    if load["moves"]:
        misuse('--load: expected a load of forces, found "one that moves points: move them in the engine"')
    for point, *force in load["forces"]:
        forces[point] += force
    return forces


def setting_of(net, given):
    """The setting, and where other numbers are asked for than the constants were fitted for."""
    own = dict(net["setting"])
    own.update({key: value for key in ["step", "substeps", "iterations"] if (value := getattr(given, key)) is not None})
    if not (own["step"] > 0 and own["substeps"] > 0 and own["iterations"] > 0):
        misuse("--step, --substeps, --iterations: expected numbers above zero")
    if net["fitted"] and own != net["setting"]:
        words = [[of["substeps"], of["iterations"], f"{of['step']:g} s"] for of in [net["setting"], own]]
        fitted, now = ("{} substeps of {} iterations in {}".format(*words[0]), "{} of {} in {}".format(*words[1]))
        print(f"Beware: the constants were fitted for {fitted}; with {now} the body has another stiffness", file=sys.stderr)
    return own


def seconds(word):
    """A time above 0 s, below the 1e300 s that the program in C takes."""
    if not 0 < float(word) < 1e300:
        raise argparse.ArgumentTypeError(f"expected a time above 0 s, found {word}")
    return float(word)


if __name__ == "__main__":
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("seconds", nargs="?", type=seconds, default=2.0)
    for name, kind in [("--rest", str), ("--load", str), ("--step", seconds), ("--substeps", int), ("--iterations", int)]:
        arguments.add_argument(name, type=kind)
    arguments.add_argument("--single", action="store_true")
    given = arguments.parse_args()
    net = read(Path(__file__).parent / "network.json")
    body = Body(net, setting_of(net, given), forces_of(net, given.load), np.float32 if given.single else np.float64, bool(given.rest))
    start, steps = body.x.copy(), round(given.seconds / body.h)
    if given.rest:
        steps = body.settle()
    else:
        for _ in range(steps):
            body.substep()
    moved = np.linalg.norm(body.x - start, axis=1)
    if not np.all(np.isfinite(moved)):
        sys.exit("the motion has diverged")
    if given.rest:
        np.savetxt(given.rest, body.x, fmt="%.17g")
    words = "at rest after " if given.rest else ""
    print(f"{len(start)} points, {words}{steps * body.h:.4g} s: the largest displacement is {moved.max():.4g} m, at point {moved.argmax()}")

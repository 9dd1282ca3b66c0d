# Beware: 17 of 412 cells are inside out at rest under gravity and the load "shear".
"""A springfit network in Newton (pip install newton numpy).

    python run.py            half a second of motion, then where the points are
    python run.py 2          two seconds
    python run.py --rest F   comes to rest and writes the positions to the file F
    python run.py --load N   any of these under the load N of the scene as well
    python run.py --rest F 1e4 0.3   the same with the program's own finite elements, E = 1e4 Pa and nu = 0.3, to compare
    --step S, --substeps N, --iterations N   in place of the setting that the constants were fitted for

What was converted: springs are springs, with their constants, rest lengths and dampers. A spring of constant K on the volume V of a
tetrahedron is a tetrahedron without shear modulus (k_mu = 0): its rest pose is enlarged to the rest volume V0 of the spring, and
k_lambda = K V0. Points that are held have no mass. The solver is explicit: its step is 0.5 of the longest stable one at rest.
Constants that were fitted for a setting of SolverVBD or SolverXPBD are moved by that solver at that setting, without dampers, which would
change where the body rests. VBD gets colours in which the ends of springs differ as well; XPBD leaves out tetrahedra without shear
modulus, and gets a millionth of k_lambda.
A hinge of constant k is an edge with edge_ke = k/L, L its length at rest, for Newton's energy is 1/2 ke L (theta - rest)^2; its angles have
the other sign. Networks with hinges are moved by SolverVBD, in 10 iterations of twice the longest explicit step: the bending forces of the
explicit solver and of SolverXPBD lack a factor and do not balance.
Where stress relaxes, the script sets constants, rest lengths and activations of tetrahedra before each step, as the class Memory below says.
Cells that are inside out at the end are counted and printed; the program then ends with 1, as it does where the body does not come
to rest.
"""
import sys
from pathlib import Path

import newton
import numpy as np
import warp


class Memory:
    """What a body remembers whose stress relaxes, at the start of each explicit step of the length h, s; with h = None all that relaxes has relaxed.

    Where shear alone relaxes, the body is an exact network of tetrahedra and each term a branch of springs of rest length zero, along `edges`, whose
    constants S relax towards those of the present shape. With e = exp(-h/tau) and gamma = (1 - e) tau/h, a step has the forces of S and of
    a content with the factor gamma, and then S <- e S + gamma (1 - e) J^(2/3) k(x). Where shear and bulk relax alike, each spring has a dashpot in
    series for each term, which has lengthened by w, and the spring acts as if its rest measure were longer by the sum of g w.
    Theory: page "Springs that forget" of the book of springfit.
    """

    def __init__(self, net, h):
        start = net["points"]
        self.springs, self.volumes = net["springs"], net["volumes"]
        self.k, self.k_volume, self.rest_volume = net["k"], net["k_volume"], net["rest_volume"]
        self.shares, times = net["relaxation_shear"], net["relaxation_time"]
        self.has_branches = not np.any(net["relaxation_bulk"])
        self.edges, self.is_relaxed = np.empty((0, 2), int), h is None
        left = 1 - self.shares.sum()
        if self.is_relaxed and not left > 1e-9:
            sys.exit("all stress of the body relaxes, so that it does not come to rest")
        if not self.is_relaxed:
            self.decay = np.exp(-h / times)
            self.mean = -np.expm1(-h / times) * times / h
        if self.has_branches:
            self.v0 = self.shape(start)[1]
            # A spring on a content at rest has k (rest - V) = mu and k V = lambda + mu. What is left of mu is beside the same bulk modulus.
            self.mu = self.k_volume * (self.rest_volume - self.v0)
            bulk = self.k_volume * self.v0 - self.mu / 3
            self.k, self.k_volume = left * self.k, (bulk + left * self.mu / 3) / self.v0
            self.rest_volume = self.v0 + left * self.mu / self.k_volume
            pairs = np.sort(self.volumes[:, [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]], axis=2).reshape(-1, 2)
            self.edges, self.edge_of = np.unique(pairs, axis=0, return_inverse=True)
            if not self.is_relaxed:
                self.state = np.outer(self.shares * self.mean, self.constants(*self.shape(start)))
        elif self.is_relaxed:
            self.k, self.k_volume = left * self.k, left * self.k_volume
        else:
            self.start = self.measures(start)
            self.last, self.creep = np.zeros_like(self.start), np.zeros((len(times), len(self.start)))

    def shape(self, x):
        """The gradients of the shape functions of the tetrahedra at x, [cells, 4, 3], and their volumes."""
        e = x[self.volumes[:, 1:]] - x[self.volumes[:, :1]]
        n = np.cross(np.roll(e, -1, 1), np.roll(e, -2, 1))
        v = np.einsum("ck,ck->c", e[:, 0], n[:, 0]) / 6
        n = n / (6 * v)[:, None, None]
        return np.concatenate([-n.sum(1, keepdims=True), n], axis=1), v

    def constants(self, n, v):
        """The constants along the edges of springs that have relaxed to this shape."""
        of_pairs = -np.einsum("cak,cbk->cab", n, n)[:, [0, 0, 0, 1, 1, 2], [1, 2, 3, 2, 3, 3]]
        own = (self.mu * self.v0 * (v / self.v0) ** (2 / 3))[:, None] * of_pairs
        return np.bincount(self.edge_of.ravel(), own.ravel(), len(self.edges))

    def measures(self, x):
        """The lengths of the springs and the volumes."""
        e = x[self.volumes[:, 1:]] - x[self.volumes[:, :1]] if len(self.volumes) else np.empty((0, 3, 3))
        return np.concatenate([np.linalg.norm(x[self.springs[:, 1]] - x[self.springs[:, 0]], axis=1), np.linalg.det(e) / 6])

    def step(self, x):
        """At the end of a step, at x: by how much the rest lengths and rest volumes are longer, and the constants of the springs along `edges`. The
        next call is that of the next step."""
        count = len(self.springs)
        if self.is_relaxed:
            return np.zeros(count), np.zeros(len(self.volumes)), np.zeros(len(self.edges))
        if self.has_branches:
            n, v = self.shape(x)
            push = self.shares @ self.mean * self.mu * self.v0 * (v / self.v0) ** (2 / 3) / v
            now = self.state.sum(axis=0)
            self.state = self.decay[:, None] * self.state + np.outer(self.shares * self.mean * (1 - self.decay), self.constants(n, v))
            return np.zeros(count), push / self.k_volume, now
        c = self.measures(x) - self.start
        decay = self.decay[:, None]
        self.creep = decay * self.creep + (1 - decay) * self.last + np.outer(1 - self.mean, c - self.last)
        self.last = c
        longer = self.shares @ self.creep
        return longer[:count], longer[count:], np.empty(0)



def settle(advance, energy, damp, periods):
    """Advances until a body is at rest. The first maximum of the kinetic energy is after a quarter of the slowest motion; from then on
    all velocities are multiplied so that this motion hardly swings, for so many quarters as long. The program ends with 1 where the
    kinetic energy is then above a ten-thousandth of that maximum, which is within reach of numbers of 32 bits."""
    highest = quarter = count = moving = 0
    while not quarter or count <= periods * quarter:
        advance()
        moving = energy()
        if not np.isfinite(moving):
            sys.exit("the motion has diverged")
        count += 1
        if not quarter and moving >= highest:
            highest = moving
            continue
        quarter = quarter or max(count, 3)
        damp(np.exp(-np.pi / quarter))
    if moving > 1e-4 * highest:
        sys.exit(f"the body has not come to rest: its kinetic energy is still {moving / highest:.2g} of the highest")


def taken(net, arguments):
    """The forces [points, 3], N, of the load that --load names, and the other arguments."""
    if {"-h", "--help"} & set(arguments):
        print(__doc__)
        sys.exit()
    forces = np.zeros((len(net["points"]), 3))
    if arguments[-1:] == ["--rest"]:
        sys.exit("--rest: expected a file for the positions, found none")
    if "--rest" in arguments and not Path(arguments[arguments.index("--rest") + 1]).resolve().parent.is_dir():
        sys.exit(f"--rest: expected a file in a folder that is there, found {arguments[arguments.index('--rest') + 1]}")
    if "--load" not in arguments:
        return forces, arguments
    place = arguments.index("--load")
    name, names = "".join(arguments[place + 1 : place + 2]), net["load_names"].tolist()
    if name not in names:
        sys.exit(f"--load: expected one of {names}, found {name!r}")
    number = names.index(name)
    if np.any(net["moved_of"] == number):
        sys.exit(f"--load: expected a load of forces, found {name!r}, which moves points: move them in the program")
    own = net["load_of"] == number
    forces[net["load_points"][own]] = net["load_forces"][own]
    return forces, arguments[:place] + arguments[place + 2 :]


def seconds(given, usual):
    """The time of a motion, s."""
    try:
        return float(given[0]) if given else usual
    except ValueError:
        sys.exit(f"expected --rest FILE, --load NAME or the seconds of a motion, found {given[0]!r}: --help has all")


def keep_rest(net, x, file):
    """Writes the positions [points, 3], m, as an array of NumPy, and says where and how far the body has moved."""
    file = Path(file) if file.endswith(".npy") else Path(file + ".npy")
    np.save(file, x)
    moved = np.linalg.norm(x - net["points"], axis=1)
    print(f"{len(x)} points at rest: the largest displacement is {moved.max():.4g} m, at point {moved.argmax()}; written: {file}")


def inverted(net, x):
    """The number of simplices of the mesh that are inside out at the positions x."""
    cells = net["tets"]
    if not len(cells):
        return 0
    d = cells.shape[1] - 1
    content = lambda x: np.linalg.det(x[cells[:, 1:], :d] - x[cells[:, :1], :d])
    return int(np.sum(~(content(np.asarray(x, float)) * content(net["points"]) > 0)))


def judge(net, x):
    """Ends with 1 and says why if the motion has diverged, or cells of the mesh are inside out at the positions x."""
    if not np.all(np.isfinite(x)):
        sys.exit("the motion has diverged")
    if count := inverted(net, x):
        sys.exit(f"{count} of {len(net['tets'])} cells are inside out: the load is beyond what the springs stand")


folder = Path(__file__).parent
net = np.load(folder / "network.npz")
points, masses, springs, k, rest = (net[name] for name in ["points", "masses", "springs", "k", "rest"])
volumes, k_volume, rest_volume = (net[name] for name in ["volumes", "k_volume", "rest_volume"])
fitted = {name: net[name].ravel()[0].item() for name in ["method", "step", "substeps", "iterations", "relaxation"] if name in net}
setting = dict(fitted)  # empty where the constants are those of equations that are solved
has_hinges = "hinges" in net
step = setting["step"] / setting["substeps"] if setting else (2 if has_hinges else 0.5) * float(net["dt_max"])  # s


def build(material=None, memory=None):
    """The model, to which more may be added; or Newton's own finite elements of the same tetrahedra, of material (E, nu)."""
    builder = newton.ModelBuilder(gravity=tuple(net["gravity"].tolist()))
    mass = masses.copy()
    mass[net["fixed"]] = 0.0
    count = len(points)
    builder.add_particles([tuple(x) for x in points], [(0.0, 0.0, 0.0)] * count, mass.tolist(), [1e-5] * count)
    if material:
        young, poisson = material
        mu, lam = young / (2 + 2 * poisson), young * poisson / ((1 + poisson) * (1 - 2 * poisson))
        for corners in net["tets"].tolist():
            builder.add_tetrahedron(*corners, mu, lam, 0.0)
        return builder
    # What a body remembers has springs of rest length zero beside its own, and constants of its own.
    branch = memory.edges.tolist() if memory else []
    more = [0.0] * len(branch)
    builder.spring_indices.extend(springs.ravel().tolist() + sum(branch, []))
    builder.spring_rest_length.extend(rest.tolist() + more)
    builder.spring_stiffness.extend((memory.k if memory else k).tolist() + more)
    builder.spring_damping.extend(([0.0] * len(springs) if setting else net["damper"].tolist()) + more)
    builder.spring_control.extend([0.0] * (len(springs) + len(branch)))
    of_volumes = (memory.k_volume, memory.rest_volume) if memory else (k_volume, rest_volume)
    for corners, constant, at_rest in zip(volumes, *of_volumes):
        x = points[corners]
        edges = (x[1:] - x[0]).T
        scale = (at_rest / (np.linalg.det(edges) / 6)) ** (1 / 3)
        builder.tet_indices.append(tuple(corners.tolist()))
        builder.tet_poses.append(np.linalg.inv(scale * edges).tolist())
        builder.tet_activations.append(0.0)
        shear = 1e-6 * constant * at_rest if setting.get("method") == "newton-xpbd" else 0.0
        builder.tet_materials.append((shear, constant * at_rest, 0.0))
    if has_hinges:
        apex, a, b, other = net["hinges"].T
        stiffness = net["k_hinge"] / np.linalg.norm(points[b] - points[a], axis=1)
        nothing = [0.0] * len(stiffness)
        builder.add_edges(*(ends.tolist() for ends in (apex, other, a, b)), rest=(-net["rest_hinge"]).tolist(), edge_ke=stiffness.tolist(), edge_kd=nothing)
    if "colours" in net:
        colours = net["colours"]
        builder.set_coloring([np.flatnonzero(colours == colour) for colour in range(colours.max() + 1)])
    return builder


def solver_of(model, material=None):
    """The solver, for a step of `step`: the one that the constants were fitted for, or the explicit one."""
    solvers = newton.solvers
    if material or not (setting or has_hinges):
        return solvers.SolverSemiImplicit(model)
    if has_hinges or setting["method"] == "newton-vbd":
        return solvers.SolverVBD(model, iterations=setting.get("iterations", 10))
    return solvers.SolverXPBD(model, iterations=setting["iterations"], soft_body_relaxation=setting["relaxation"])


class Motion:
    """The body in motion under forces on its points, [points, 3], N, by the solver of the network, elements by the explicit one. One that
    has relaxed keeps the stiffness that is left."""

    def __init__(self, material=None, forces=None, has_relaxed=False):
        self.forces = forces
        self.step = 0.5 * float(net["dt_max"]) if material else step
        forgets = "relaxation_time" in net and not material
        self.memory = Memory(net, None if has_relaxed else self.step) if forgets else None
        model = build(material, self.memory).finalize()
        self.model, self.solver, self.control = model, solver_of(model, material), model.control()
        self.now, self.after = model.state(), model.state()

    def advance(self):
        self.now.clear_forces()
        if self.forces is not None:
            self.now.particle_f.assign(self.forces)
        if self.memory and not self.memory.is_relaxed:
            self.remember()
        self.solver.step(self.now, self.after, self.control, None, self.step)
        self.now, self.after = self.after, self.now

    def remember(self):
        longer, larger, constants = self.memory.step(self.positions())
        self.model.spring_rest_length.assign(np.float32(np.concatenate([rest + longer, np.zeros_like(constants)])))
        self.model.spring_stiffness.assign(np.float32(np.concatenate([self.memory.k, constants])))
        if len(volumes):
            self.control.tet_activations.assign(np.float32(-larger / self.memory.rest_volume))

    def positions(self):
        return self.now.particle_q.numpy().astype(float)

    def velocities(self):
        return self.now.particle_qd.numpy().astype(float)


def come_to_rest(material=None, forces=None):
    """Positions at rest."""
    body = Motion(material, forces, has_relaxed=True)
    weight = masses.copy()
    weight[net["fixed"]] = 0.0
    energy = lambda: float(weight @ np.sum(body.velocities() ** 2, axis=1))
    # Vertex block descent of hinges settles as early; measured: the same points after 25, 40 and 120.
    quarters = 40 if has_hinges else 120
    settle(body.advance, energy, lambda factor: body.now.particle_qd.assign(body.velocities() * factor), quarters)
    return body.positions()


def misuse(words):
    print(words, file=sys.stderr)
    sys.exit(2)


def change_setting(arguments):
    """Puts the numbers of --step, --substeps and --iterations into the setting, says so, and returns the other arguments."""
    global step
    for name, kind, expected in [("step", float, "a time in s"), ("substeps", int, "a whole number"), ("iterations", int, "a whole number")]:
        if f"--{name}" not in arguments:
            continue
        if not setting:
            misuse(f"--{name}: expected a network that is fitted for a solver of Newton, found one for equations that are solved; a fit with engine = {{ method = \"newton-vbd\" }} has such constants")
        place = arguments.index(f"--{name}")
        word = "".join(arguments[place + 1 : place + 2])
        try:
            value = kind(word)
        except ValueError:
            value = np.nan
        if not 0 < value < np.inf:
            misuse(f'--{name}: expected {expected} above zero, found "{word}"; the network is fitted for {fitted[name]:g}')
        setting[name] = value
        arguments = arguments[:place] + arguments[place + 2 :]
    if setting != fitted:
        words = [[of["substeps"], of["iterations"], f"{of['step']:g} s"] for of in [fitted, setting]]
        first, now = ("{} substeps of {} iterations in {}".format(*words[0]), "{} of {} in {}".format(*words[1]))
        print(f"Beware: the constants were fitted for {first}; with {now} the body has another stiffness", file=sys.stderr)
        step = setting["step"] / setting["substeps"]
    return arguments


if __name__ == "__main__":
    # Nothing is differentiated: without their adjoints kernels compile in half of the time.
    warp.config.enable_backward = False
    forces, given = taken(net, change_setting(sys.argv[1:]))
    if given[:1] == ["--rest"]:
        x = come_to_rest(tuple(map(float, given[2:])) or None, forces)
        keep_rest(net, x, given[1])
    else:
        duration = seconds(given, 0.5)
        body = Motion(forces=forces)
        for _ in range(round(duration / step)):
            body.advance()
        x = body.positions()
        moved = np.linalg.norm(x - points, axis=1)
        print(f"{len(points)} points, {duration:g} s: the largest displacement is {moved.max():.4g} m, at point {moved.argmax()}")
    judge(net, x)

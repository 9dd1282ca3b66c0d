# Beware: 17 of 412 cells are inside out at rest under gravity and the load "shear".
"""A springfit network in Blender (pip install bpy numpy, or Blender itself).

    python run.py            one second of motion, written to network.blend
    python run.py 2          two seconds
    python run.py --load N   any of these under the load N of the scene as well
    python run.py --rest F   comes to rest and writes the positions to the file F
    blender --python run.py -- 2   the same in Blender, which stays open

What was converted: the object "springs" is a mesh with a vertex for each point and an edge for each spring. Attributes of its edges are
constant (N/m), rest (m) and damping (kg/s), those of its vertices mass (kg) and fixed. The object "surface" has the triangles of the
boundary over the same vertices. Hinges are edges of an object "hinges" with the attributes constant (N m) and rest (rad).
Blender's soft bodies have one stiffness for all edges, and its cloth bends by forces at the corners that are no moment of an angle and
do not balance, so that neither takes these attributes: this script moves the network by symplectic Euler at half the longest stable
step, with the springs on volumes and areas and the hinges, and all objects get the motion as shape keys, one for each frame. Geometry
nodes read the attributes by their names. Blender counts in 32 bits.
Stress that relaxes is that of the class Memory below.
Cells that are inside out at the end are counted and printed; the program then ends with 1, as it does where the body does not come
to rest.
"""
import sys
from pathlib import Path

import bpy
import numpy as np


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
points, masses, springs, k, rest, damper = (net[name] for name in ["points", "masses", "springs", "k", "rest", "damper"])
volumes, k_volume, rest_volume = (net[name] for name in ["volumes", "k_volume", "rest_volume"])
areas, k_area, rest_area = (net.get(name, np.empty(0)) for name in ["areas", "k_area", "rest_area"])
hinges, k_hinge, rest_hinge = (net.get(name, np.empty(0)) for name in ["hinges", "k_hinge", "rest_hinge"])
step = 0.5 * float(net["dt_max"])  # s
free = np.isnan(net["held"])
rate = 24  # frames per second
memory = None  # of a body whose stress relaxes


def remember(h):
    """Begins a motion in steps of h, s; with None all that relaxes has relaxed."""
    global memory, k, k_volume, rest_volume
    if "relaxation_time" in net:
        memory = Memory(net, h)
        k, k_volume, rest_volume = memory.k, memory.k_volume, memory.rest_volume


def gathered(corners, forces):
    """The sum of the forces [springs, 3] on each point of `corners`."""
    return np.stack([np.bincount(corners, forces[:, axis], len(points)) for axis in range(3)], axis=1)


def dot(a, b):
    return np.sum(a * b, axis=1, keepdims=True)


def turns(x):
    """The angles of the hinges beside those at rest, rad, and their gradients by the apex, the ends of the edge and the apex beyond it."""
    apex, a, b, last = (x[hinges[:, i]] for i in range(4))
    t, u, w = b - a, apex - a, last - a
    size = np.sqrt(dot(t, t))
    t = t / size
    feet = dot(u, t) / size, dot(w, t) / size
    up, away = u - dot(u, t) * t, w - dot(w, t) * t
    n = np.cross(t, up)
    g0, g3 = n / dot(up, up), np.cross(away, t) / dot(away, away)
    # n is as long as up, and so are both sides of this right-handed pair.
    angle = np.arctan2(dot(away, n), dot(away, -up))[:, 0] - rest_hinge
    return angle, [g0, (feet[0] - 1) * g0 + (feet[1] - 1) * g3, -feet[0] * g0 - feet[1] * g3, g3]


def force(x, v, applied=0.0):
    """The force on each point, N: `applied`, springs with dampers and what they remember, springs on volumes and areas, hinges, weight, and damping of the masses."""
    i, j = springs.T
    r = x[j] - x[i]
    length = np.maximum(np.linalg.norm(r, axis=1), 1e-300)
    along = np.sum(r * (v[j] - v[i]), axis=1) / length
    longer, larger, constants = memory.step(x) if memory else (0.0, 0.0, ())
    pull = ((k * (length - rest - longer) + damper * along) / length)[:, None] * r
    total = applied + gathered(i, pull) - gathered(j, pull) + masses[:, None] * (net["gravity"] - float(net["damping"]) * v)
    if len(constants):
        i, j = memory.edges.T
        pull = constants[:, None] * (x[j] - x[i])
        total += gathered(i, pull) - gathered(j, pull)
    if len(volumes):
        edges = (x[volumes[:, 1:]] - x[volumes[:, :1]]).transpose(0, 2, 1)
        volume = np.linalg.det(edges) / 6
        slopes = volume[:, None, None] * np.linalg.inv(edges)
        slopes = np.concatenate([-slopes.sum(1, keepdims=True), slopes], axis=1)
        pull = (k_volume * (volume - rest_volume - larger))[:, None, None] * slopes
        for a in range(4):
            total -= gathered(volumes[:, a], pull[:, a])
    if len(areas):
        a, b, c = (x[areas[:, i]] for i in range(3))
        normal = np.cross(b - a, c - a)
        size = np.sqrt(dot(normal, normal))
        tension = k_area[:, None] * (size / 2 - rest_area[:, None])
        for i, opposite in enumerate([b - c, c - a, a - b]):
            total -= gathered(areas[:, i], tension * np.cross(opposite, normal / size) / 2)
    if len(hinges):
        angle, slopes = turns(x)
        for i, slope in enumerate(slopes):
            total -= gathered(hinges[:, i], (k_hinge * angle)[:, None] * slope)
    return total


def advance(x, v, applied=0.0):
    v = np.where(free, v + step * force(x, v, applied) / masses[:, None], 0.0)
    return x + step * v, v


def move(duration, applied=0.0):
    """The positions at each frame."""
    remember(step)
    x, v = points, np.zeros_like(points)
    frames, count = [points], 0
    for frame in range(1, round(duration * rate) + 1):
        while count * step < frame / rate:
            x, v = advance(x, v, applied)
            count += 1
        if not np.all(np.isfinite(x)):
            sys.exit("the motion has diverged")
        frames.append(x)
    return frames


def come_to_rest(applied=0.0):
    """Positions at rest."""
    remember(None)
    body = {"x": points, "v": np.zeros_like(points)}

    def step_on():
        body["x"], body["v"] = advance(**body, applied=applied)

    def damp(factor):
        body["v"] = body["v"] * factor

    settle(step_on, lambda: float(masses @ np.sum(body["v"] ** 2, axis=1)), damp, 120)
    return body["x"]


def objects():
    """The objects of the network, in a collection of their own."""
    collection = bpy.data.collections.new("springfit")
    bpy.context.scene.collection.children.link(collection)
    made = []
    of_springs = [("constant", "FLOAT", k), ("rest", "FLOAT", rest), ("damping", "FLOAT", damper)]
    bodies = [("springs", springs, [], of_springs), ("surface", [], net["surface"].tolist(), [])]
    if len(hinges):
        # Two hinges at a joint of three triangles are two edges.
        bodies.append(("hinges", hinges[:, 1:3], [], [("constant", "FLOAT", k_hinge), ("rest", "FLOAT", rest_hinge)]))
    for name, edges, faces, of_edges in bodies:
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata(points.tolist(), [list(map(int, edge)) for edge in edges], faces)
        of_points = [("mass", "FLOAT", masses), ("fixed", "BOOLEAN", ~free.any(axis=1))]
        for domain, attributes in [("POINT", of_points), ("EDGE", of_edges)]:
            for attribute, kind, values in attributes:
                values = values.astype(np.float32 if kind == "FLOAT" else bool)
                mesh.attributes.new(attribute, kind, domain).data.foreach_set("value", values)
        made.append(bpy.data.objects.new(name, mesh))
        collection.objects.link(made[-1])
    return made


def keep(made, frames):
    """The positions of the frames as absolute shape keys: the key n is the shape at frame n + 1."""
    for body in made:
        for n, x in enumerate(frames):
            key = body.shape_key_add(name=f"frame {n + 1}", from_mix=False)
            key.interpolation = "KEY_LINEAR"
            key.data.foreach_set("co", x.astype(np.float32).ravel())
        keys = body.data.shape_keys
        keys.use_relative = False
        for n in range(len(frames)):
            keys.eval_time = keys.key_blocks[n].frame
            keys.keyframe_insert("eval_time", frame=n + 1)
    scene = bpy.context.scene
    scene.render.fps, scene.frame_start, scene.frame_end = rate, 1, len(frames)


def shown(body, frame):
    """The positions that Blender shows at a frame."""
    bpy.context.scene.frame_set(frame)
    mesh = body.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    x = np.empty(points.size, dtype=np.float32)
    mesh.vertices.foreach_get("co", x)
    return x.reshape(points.shape).astype(float)


if __name__ == "__main__":
    given = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    applied, given = taken(net, given)
    if bpy.app.background:
        bpy.ops.wm.read_factory_settings(use_empty=True)
    is_rest = given[:1] == ["--rest"]
    frames = [points, come_to_rest(applied)] if is_rest else move(seconds(given, 1.0), applied)
    made = objects()
    keep(made, frames)
    x = shown(made[0], len(frames))
    if is_rest:
        keep_rest(net, x, given[1])
    moved = np.linalg.norm(x - points, axis=1)
    print(f"{len(points)} points, {len(frames)} frames: the largest displacement at the last is {moved.max():.4g} m, at point {moved.argmax()}")
    if bpy.app.background:
        bpy.ops.wm.save_as_mainfile(filepath=str(folder / "network.blend"), compress=True)
    judge(net, frames[-1])

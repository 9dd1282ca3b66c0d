"""The modulus that a simulator shows, against the modulus in its input. Standard bodies at rest in it, beside finite elements.

    python referee/engines/run.py --engine mujoco --engine newton [--solver NAME] [--springfit PROGRAM] [--out FOLDER]

A bar under tension, torsion and bending and a block in shear, of tetrahedra, are put into the simulator (requirements.txt) as springs by
`springfit export` and as its own finite elements. At rest the tip and the energy are compared with our finite elements of the same
mesh, and with those of refined meshes. Where the simulator's own elements differ, E is multiplied by the factor that makes tension
right, and all bodies are run again. Writes engines.md, engines.json and engines.svg.
"""
import argparse
import importlib
import json
import sys
import tempfile
import time
from pathlib import Path

import bodies
import chart
import table

ENGINES = ["mujoco", "newton", "lammps"]
# An engine whose energy of tension is nearer than this to finite elements is not repaired, percent.
RIGHT = 0.5


class Referee:
    """The rows of one engine."""

    def __init__(self, name, only, springfit, prepared, folder, keep):
        self.name, self.engine = name, importlib.import_module(f"with_{name}")
        self.springfit, self.prepared, self.folder, self.keep = springfit, prepared, folder, keep
        self.only, self.rows, self.maps = only, [], []

    def script(self, scene, poisson, network):
        out = self.folder / f"{self.name}-{scene}-{poisson}-{network}"
        if not out.exists():
            file = self.prepared[scene, poisson].networks[network]
            bodies.run(self.springfit, "export", file, "--to", self.name, "--gravity", "0 0 0", "--out", out)
        return self.engine.load(out)

    def measure(self, solver, model, network, poisson, told=None):
        """A row for each load. `told` are E and nu of the engine's own elements."""
        for scene in bodies.SCENES:
            body = self.prepared[scene, poisson]
            script = self.script(scene, poisson, network)
            for case in body.cases:
                start = time.perf_counter()
                # Half the difference of both signs of the load: what is of second order in it cancels out.
                ends = [self.engine.rest(script, solver, sign * case.forces, body.slowest, told) for sign in (1, -1)]
                seconds = time.perf_counter() - start
                self.rows.append(self.row(solver, model, poisson, told, case, case.networks[network], ends, seconds))
                self.rows[-1]["warnings"] = self.engine.warnings()
                print(table.line(self.rows[-1]), flush=True)
        self.keep()

    def row(self, solver, model, poisson, told, case, own, ends, seconds):
        row = {"engine": self.name, "solver": solver, "model": model, "load": case.load, "poisson": poisson, "seconds": seconds}
        row["told"] = dict(zip(["young", "poisson"], told)) if told else None
        row["truth_J"], row["truth_uncertainty_percent"] = case.truth / 2, case.uncertainty
        row["tip_of_finite_elements_m"], row["energy_of_finite_elements_J"] = (f(case.finite_elements) for f in (case.tip, case.energy))
        row["at_rest"] = all(end is not None for end in ends)
        if row["at_rest"]:
            u = (ends[0] - ends[1]) / 2
            row["tip_m"], row["energy_J"] = case.tip(u), case.energy(u)
            percent = lambda found, expected: 100 * (found / expected - 1)
            row["of_model_percent"] = percent(row["energy_J"], case.energy(own))
            row["tip_percent"] = percent(row["tip_m"], row["tip_of_finite_elements_m"])
            row["energy_percent"] = percent(row["energy_J"], row["energy_of_finite_elements_J"])
            row["truth_percent"] = percent(row["energy_J"], row["truth_J"])
        return row

    def energy_of_tension(self, solver, model, poisson):
        for row in self.rows:
            if (row["solver"], row["model"], row["poisson"], row["load"]) == (solver, model, poisson, "tension"):
                return row.get("energy_percent")

    def run(self):
        for poisson in bodies.POISSON:
            for solver, networks in self.engine.solvers.items():
                if self.only and solver not in self.only:
                    continue
                if solver in self.engine.own_elements:
                    self.own_elements(solver, poisson)
                for network in networks:
                    self.measure(solver, f"{network} springs", network, poisson)

    def own_elements(self, solver, poisson):
        self.measure(solver, "own elements", "exact", poisson, (bodies.YOUNG, poisson))
        error = self.energy_of_tension(solver, "own elements", poisson)
        if error is None or abs(error) < RIGHT:
            return
        # The energy of a linear body under a load is inverse to E.
        factor = 1 + error / 100
        self.measure(solver, "own elements, E repaired", "exact", poisson, (factor * bodies.YOUNG, poisson))
        entry = {"engine": self.name, "solver": solver, "poisson": poisson, "factor": factor, "derived": None}
        if derived := self.engine.same_at_small_strain(solver, bodies.YOUNG, poisson):
            self.measure(solver, "own elements, E and nu derived", "exact", poisson, derived)
            entry["derived"] = {"factor": derived[0] / bodies.YOUNG, "poisson": derived[1]}
        self.maps.append(entry)
        self.keep()


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--engine", action="append", choices=ENGINES, help="may be repeated; default all")
    arguments.add_argument("--solver", action="append", help="only this solver of an engine; may be repeated")
    arguments.add_argument("--springfit", default="springfit", help="the program")
    arguments.add_argument("--out", type=Path, default=Path("out/engines"))
    given = arguments.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    referees, missing = [], []

    def keep():
        """Writes what is known so far."""
        record = {
            "versions": {referee.name: referee.engine.version for referee in referees},
            "young": bodies.YOUNG,
            "not_run": missing,
            "maps": [entry for referee in referees for entry in referee.maps],
            "rows": [row for referee in referees for row in referee.rows],
        }
        (given.out / "engines.json").write_text(json.dumps(record, indent=1) + "\n")
        (given.out / "engines.md").write_text(table.page(record))
        (given.out / "engines.svg").write_text(chart.svg(record))

    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        prepared = {
            (scene, poisson): bodies.prepare(given.springfit, scene, poisson, folder)
            for scene in bodies.SCENES
            for poisson in bodies.POISSON
        }
        for name in given.engine or ENGINES:
            try:
                referees.append(Referee(name, given.solver, given.springfit, prepared, folder, keep))
            except ImportError as error:
                missing.append(f"{name}: {error}")
                continue
            referees[-1].run()
        keep()
    names = ", ".join(f"{referee.name} {referee.engine.version}" for referee in referees)
    print(f"\n{sum(len(referee.rows) for referee in referees)} bodies in {names or 'no engine'}; written to {given.out}")
    for words in missing:
        print(f"not run: {words}")
    sys.exit(1 if missing and given.engine else 0)


if __name__ == "__main__":
    main()

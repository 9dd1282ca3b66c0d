"""How time and memory of a run grow with the body: boxes of hexahedra and of tetrahedra with one load, by `springfit run`, each in a process of
its own. Processor time of the whole run and its largest memory; seconds on the clock of its stages, from report.json. The last row of a body has
the exponents p of `a·Nᵖ`, N unknowns, by least squares over the three largest boxes.

Usage: python benches/growth.py [--springfit target/release/springfit] [--largest 3100000] [--write docs/src/studies/speed.md]
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from math import log
from pathlib import Path
from statistics import linear_regression

SCENE = """
[mesh]
box = {{ element = "{element}", size = [1, 1, 1], cells = [{cells}, {cells}, {cells}] }}
[material]
young = 1e6
poisson = 0.3
[[fix]]
group = "zmin"
[[load]]
name = "shear"
group = "zmax"
traction = [1e3, 0, 0]
[[fit]]
objective = "{objective}"
"""
BODIES = {"hex8": "offdiag", "tet4": "exact"}
CELLS = [6, 10, 16, 25, 40, 63, 100]
HEADER = ["body", "unknowns", "processor, s", "memory, MB", "fit", "assembly", "solved, finite elements", "solved, network", "iterations"]


def unknowns_of(cells):
    """Those of a box of cells³ cubes that is held on one side."""
    return 3 * cells * (cells + 1) ** 2


def measure(springfit, element, cells, folder):
    """The columns of one box, from unknowns on."""
    scene = folder / "scene.toml"
    scene.write_text(SCENE.format(element=element, cells=cells, objective=BODIES[element]))
    with open(folder / "errors", "w+") as errors:
        run = subprocess.Popen([springfit, "run", scene, "--out", folder / "out"], stdout=subprocess.DEVNULL, stderr=errors)
        _, status, used = os.wait4(run.pid, 0)
        if status:
            errors.seek(0)
            sys.exit(f"{element}, {cells}³ cells: {errors.read()[-1000:]}")
    fit = json.loads((folder / "out" / "report.json").read_text())["fits"][0]
    load = fit["loads"][0]
    stages = [fit["seconds"], fit["seconds_assembly"], load["seconds_fem"], load["seconds_lem"]]
    iterations = [load[solver].get("iterations") for solver in ("solver_fem", "solver_lem")]
    return [unknowns_of(cells), used.ru_utime + used.ru_stime, used.ru_maxrss / 1024, *stages, iterations]


def exponent(unknowns, figures):
    """p of the least squares of ln figure = ln a + p ln unknowns."""
    return linear_regression([log(n) for n in unknowns], [log(f) for f in figures]).slope


def table(springfit, largest):
    yield "| " + " | ".join(HEADER) + " |"
    yield "|" + "---|" * len(HEADER)
    for element in BODIES:
        found = []
        for cells in CELLS:
            if unknowns_of(cells) > largest:
                break
            with tempfile.TemporaryDirectory() as folder:
                found.append(measure(springfit, element, cells, Path(folder)))
            unknowns, processor, memory, *stages, iterations = found[-1]
            counts = "factor" if iterations[0] is None else f"{iterations[0]}, {iterations[1]}"
            yield f"| {cells}³ {element} | {unknowns} | {processor:.2f} | {memory:.0f} | " + " | ".join(f"{s:.3f}" for s in stages) + f" | {counts} |"
        last = found[-3:]
        if len(last) > 2:
            exponents = [exponent([row[0] for row in last], [row[column] for row in last]) for column in range(1, 7)]
            yield f"| {element}, exponents | | " + " | ".join(f"{p:.2f}" for p in exponents) + " | |"


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--springfit", default="target/release/springfit")
    options.add_argument("--largest", type=int, default=3_100_000, help="unknowns")
    options.add_argument("--write", type=Path, help="a page with the marks <!-- growth --> and <!-- end growth -->")
    options = options.parse_args()
    lines = []
    for line in table(Path(options.springfit).resolve(), options.largest):
        print(line, flush=True)
        lines.append(line)
    if options.write:
        start, end = "<!-- growth -->\n", "<!-- end growth -->"
        text = options.write.read_text()
        if text.count(start) != 1 or text.count(end) != 1:
            sys.exit(f"{options.write}: expected the marks {start.strip()} and {end} once each")
        head, rest = text.split(start)
        options.write.write_text(head + start + "\n".join(lines) + "\n" + end + rest.split(end)[1])


if __name__ == "__main__":
    main()

"""How time and memory of a run grow with the body: boxes of hexahedra and of tetrahedra with one load, by `springfit run`, each in a process of
its own. Processor time of the whole run and its largest memory; seconds on the clock of its stages, from report.json. The last row of a body has
the exponents p of `a·Nᵖ`, N unknowns, by least squares over the three largest boxes. With `--whole` the hexahedra are fitted as a whole: with a
factor for each group of springs, and with one for each spring and a given regularization.

Usage: python benches/growth.py [--whole] [--springfit target/release/springfit] [--largest 3100000] [--write docs/src/studies/speed.md]
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
{fit}
"""
FITS = {"hex8": 'objective = "offdiag"', "tet4": 'objective = "exact"'}
CELLS = [6, 10, 16, 25, 40, 63, 100]
HEADER = ["fit", "assembly", "solved, finite elements", "solved, network", "iterations"]
WHOLE_FIT = 'objective = "whole"\nstart = "frobenius"\nunknowns = '
WHOLE_FITS = {"hex8": WHOLE_FIT + '"group"', "hex8, each spring": WHOLE_FIT + '"spring"\nregularization = 1.0'}
WHOLE_CELLS = [6, 10, 16, 25, 35, 47]
WHOLE_HEADER = ["fit, s", "springs", "equations", "unseen loads, start", "fitted"]


def unknowns_of(cells):
    """Those of a box of cells³ cubes that is held on one side."""
    return 3 * cells * (cells + 1) ** 2


def measure(springfit, body, cells, fit):
    """The report of one box, its processor time in s, and its largest memory in MB."""
    with tempfile.TemporaryDirectory() as folder, open(Path(folder) / "errors", "w+") as errors:
        scene, out = Path(folder) / "scene.toml", Path(folder) / "out"
        scene.write_text(SCENE.format(element=body.split(",")[0], cells=cells, fit=fit))
        run = subprocess.Popen([springfit, "run", scene, "--out", out], stdout=subprocess.DEVNULL, stderr=errors)
        _, status, used = os.wait4(run.pid, 0)
        if status:
            errors.seek(0)
            sys.exit(f"{body}, {cells}³ cells: {errors.read()[-1000:]}")
        return json.loads((out / "report.json").read_text()), used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def of_load(report):
    """Seconds of the stages of a box under one load, and the iterations."""
    fit = report["fits"][0]
    load = fit["loads"][0]
    iterations = [load[solver].get("iterations") for solver in ("solver_fem", "solver_lem")]
    counts = "factor" if iterations[0] is None else f"{iterations[0]}, {iterations[1]}"
    return [fit["seconds"], fit["seconds_assembly"], load["seconds_fem"], load["seconds_lem"]], [counts]


def of_whole(report):
    """Seconds of a fit of the whole box, springs, how equations were solved, and mean errors under unseen loads."""
    fit = report["fits"][0]
    errors = fit["whole"]["relative_errors_validated"]
    # Nothing validates a regularization that is given.
    means = [f"{100 * sum(error[when] for error in errors) / len(errors):.2f} %" if errors else "–" for when in ("before", "after")]
    return [fit["seconds"]], [f"{report['springs']}", fit["loads"][0]["solver_fem"]["method"], *means]


def exponent(unknowns, figures):
    """p of the least squares of ln figure = ln a + p ln unknowns."""
    return linear_regression([log(n) for n in unknowns], [log(f) for f in figures]).slope


def table(springfit, largest, fits, boxes, header, columns):
    header = ["body", "unknowns", "processor, s", "memory, MB", *header]
    yield "| " + " | ".join(header) + " |"
    yield "|" + "---|" * len(header)
    for body, fit in fits.items():
        found = []
        for cells in boxes:
            unknowns = unknowns_of(cells)
            if unknowns > largest:
                break
            report, processor, memory = measure(springfit, body, cells, fit)
            seconds, words = columns(report)
            found.append([unknowns, processor, memory, *seconds])
            stages = [f"{s:.3f}" for s in seconds]
            yield f"| {cells}³ {body} | {unknowns} | {processor:.2f} | {memory:.0f} | " + " | ".join(stages + words) + " |"
        last = list(zip(*found[-3:]))
        if len(found) > 2:
            exponents = [f"{exponent(last[0], figures):.2f}" for figures in last[1:]]
            rest = [""] * (len(header) - 2 - len(exponents))
            yield f"| {body}, exponents | | " + " | ".join(exponents + rest) + " |"


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--whole", action="store_true", help="whole-object fits")
    options.add_argument("--springfit", default="target/release/springfit")
    options.add_argument("--largest", type=int, default=3_100_000, help="unknowns")
    options.add_argument("--write", type=Path, help="a page with the marks <!-- growth --> and <!-- end growth -->, or of whole growth")
    options = options.parse_args()
    mark = "whole growth" if options.whole else "growth"
    kind = (WHOLE_FITS, WHOLE_CELLS, WHOLE_HEADER, of_whole) if options.whole else (FITS, CELLS, HEADER, of_load)
    lines = []
    for line in table(Path(options.springfit).resolve(), options.largest, *kind):
        print(line, flush=True)
        lines.append(line)
    if options.write:
        start, end = f"<!-- {mark} -->\n", f"<!-- end {mark} -->"
        text = options.write.read_text()
        if text.count(start) != 1 or text.count(end) != 1:
            sys.exit(f"{options.write}: expected the marks {start.strip()} and {end} once each")
        head, rest = text.split(start)
        options.write.write_text(head + start + "\n".join(lines) + "\n" + end + rest.split(end)[1])


if __name__ == "__main__":
    main()

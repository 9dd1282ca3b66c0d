"""The memory that `springfit run --explain` expects beside what the run takes, for boxes of every element and several fits.

    python benches/memory.py [--springfit PROGRAM] [--solver cholesky] [--only tet10,hex20] [--most 1.5]

Boxes have some ten thousand unknowns, or a third of that in space with --solver cholesky. What a run takes is its largest resident memory, as the
kernel counts it. Exit code 1 if the ratio of both, either way, is more than --most.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

# Cells along an edge: iterations, and a factor.
CELLS = {
    "tri3": (130, 130), "tri6": (65, 65), "tri10": (43, 43), "quad4": (130, 130), "quad8": (70, 70), "quad9": (65, 65), "quad12": (50, 50),
    "tet4": (20, 14), "tet10": (10, 7), "tet20": (7, 5), "hex8": (20, 14), "hex20": (12, 8), "hex27": (10, 7), "wedge6": (20, 14),
    "wedge15": (11, 7), "pyramid5": (14, 9), "pyramid13": (8, 6),
}  # fmt: skip
FITS = {
    "exact": 'objective = "exact"',
    "offdiag": 'objective = "offdiag"',
    "offdiag, k >= 0": 'objective = "offdiag"\nnonnegative = true',
    "spectral": 'objective = "spectral"',
}
UNITS = {"kB": 1e3, "MB": 1e6, "GB": 1e9}


def text(element, cells, fit, solver):
    dimension = 2 if element.startswith(("tri", "quad")) else 3
    pull = [100, 20] if dimension == 2 else [100, 0, 20]
    thickness = "thickness = 0.01\n" if dimension == 2 else ""
    solver = f'[solver]\nmethod = "{solver}"\n' if solver else ""
    return (
        f'[mesh]\nbox = {{ element = "{element}", size = {[0.1] * dimension}, cells = {[cells] * dimension} }}\n'
        f"[material]\nyoung = 1e4\npoisson = 0.3\n{thickness}[[fit]]\n{fit}\n{solver}"
        f'[[fix]]\ngroup = "xmin"\n[[load]]\nname = "pull"\ngroup = "xmax"\ntraction = {pull}\n'
    )


def told(program, scene):
    """The last memory of the table of expected stages, that of all."""
    done = subprocess.run([program, "run", str(scene), "--explain"], capture_output=True, text=True, check=True)
    sizes = re.findall(r"([\d.]+) ([kMG]B)\s*$", done.stdout, re.MULTILINE)
    return float(sizes[-1][0]) * UNITS[sizes[-1][1]]


def used(program, scene):
    command = [program, "run", str(scene), "--out", str(scene.parent / "out")]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"{' '.join(command)}: exit code {process.returncode}")
    return usage.ru_maxrss * 1024


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--springfit", default="springfit", help="the program")
    parser.add_argument("--solver", help="method of [solver] in place of the one that the program chooses")
    parser.add_argument("--only", help="elements, between commas")
    parser.add_argument("--most", type=float, default=1.5, help="the largest ratio")
    options = parser.parse_args()
    worst = 1.0
    print(f"{'element':10} {'fit':16} {'told MB':>8} {'used MB':>8} {'used/told':>10}")
    for element in options.only.split(",") if options.only else CELLS:
        for name, fit in FITS.items():
            with tempfile.TemporaryDirectory() as folder:
                scene = Path(folder) / "scene.toml"
                scene.write_text(text(element, CELLS[element][bool(options.solver)], fit, options.solver))
                expected, found = told(options.springfit, scene), used(options.springfit, scene)
            ratio = found / expected
            worst = max(worst, ratio, 1 / ratio)
            print(f"{element:10} {name:16} {expected / 1e6:8.0f} {found / 1e6:8.0f} {ratio:10.2f}", flush=True)
    print(f"at most {worst:.2f} apart")
    sys.exit(worst > options.most)


if __name__ == "__main__":
    main()

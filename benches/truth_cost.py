"""What the comparison with quadratic elements costs a run: processor time of `springfit run`, in pairs that follow each other.

    python benches/truth_cost.py [--springfit PROGRAM] [--against OTHER] [--pairs 15]

Each body is run as it is and with `from = "cells"` in [reference], which asks for no other reference; with --against, by one program and by another.
Bodies that do not lock must take as long in both ways: the median of the ratios of the pairs, with half the distance between their quartiles over the
root of their number. Bodies that lock are there for what the reference takes. Times are those of user and system, of one thread, because threads that
wait for others take time as well: other work on the machine then changes little.
"""

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

FITS = """[[fit]]
objective = "exact"
[[fit]]
objective = "offdiag"
nonnegative = true
"""
PULL = '[[fix]]\ngroup = "xmin"\n[[load]]\nname = "pull"\ngroup = "xmax"\ntraction = [100, 0, 20]\n'
PLANE = PULL.replace(", 0, 20]", ", 20]")


def box(element, size, cells, poisson, conditions=PULL):
    """The text of a scene."""
    thickness = "thickness = 0.01\n" if len(size) == 2 else ""
    mesh = f'[mesh]\nbox = {{ element = "{element}", size = {list(size)}, cells = {list(cells)} }}\n'
    return f"{mesh}[material]\nyoung = 1e4\npoisson = {poisson}\n{thickness}{FITS}{conditions}"


BODIES = {
    "hex8, 12 x 12 x 12, nu 0.3": (True, box("hex8", (0.1, 0.1, 0.1), (12, 12, 12), 0.3)),
    "tet4, 10 x 10 x 10, nu 0.3": (True, box("tet4", (0.1, 0.1, 0.1), (10, 10, 10), 0.3)),
    "hex20, 6 x 6 x 6, nu 0.49": (True, box("hex20", (0.1, 0.1, 0.1), (6, 6, 6), 0.49)),
    "quad4, 120 x 40, nu 0.3": (True, box("quad4", (0.3, 0.1), (120, 40), 0.3, PLANE)),
    "hex8, 40 x 4 x 4 (a beam), nu 0.3": (True, box("hex8", (1.0, 0.1, 0.1), (40, 4, 4), 0.3)),
    "hex8, 8 x 8 x 8, nu 0.49": (False, box("hex8", (0.1, 0.1, 0.1), (8, 8, 8), 0.49)),
    "tet4, 6 x 6 x 6, nu 0.49": (False, box("tet4", (0.1, 0.1, 0.1), (6, 6, 6), 0.49)),
}


def seconds(program, text, folder):
    """Processor time of a run."""
    scene = folder / "scene.toml"
    scene.write_text(text)
    command = [program, "run", str(scene), "--out", str(folder / "out")]
    one_thread = os.environ | {"RAYON_NUM_THREADS": "1"}
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env=one_thread)
    said = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"{' '.join(command)}: {said.decode()}")
    return usage.ru_utime + usage.ru_stime


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--springfit", default="springfit", help="the program")
    parser.add_argument("--against", help="another program, which is run in place of from = \"cells\"")
    parser.add_argument("--pairs", type=int, default=15, help="how many pairs of runs of each body")
    options = parser.parse_args()
    other = options.against or 'from = "cells"'
    print(f"{'body':36} {'seconds':>8} {other[-16:]:>16} {'ratio':>7} {'±':>6}")
    for name, (is_sound, text) in BODIES.items():
        cells = text if options.against else text + '[reference]\nfrom = "cells"\n'
        ways = [(options.springfit, text), (options.against or options.springfit, cells)]
        found = [[], []]
        with tempfile.TemporaryDirectory() as folder:
            for pair in range(options.pairs + 1):
                # Each way comes first as often as second, and the first pair warms the disk.
                for way in (0, 1) if pair % 2 else (1, 0):
                    found[way].append(seconds(*ways[way], Path(folder)))
        ratios = sorted(a / b for a, b in zip(*(times[1:] for times in found)))
        lower, _, upper = statistics.quantiles(ratios, n=4)
        spread = (upper - lower) / 2 / len(ratios) ** 0.5
        first, second = (statistics.median(times[1:]) for times in found)
        remark = "" if is_sound else "  locks"
        print(f"{name:36} {first:8.2f} {second:16.2f} {statistics.median(ratios):7.3f} {spread:6.3f}{remark}", flush=True)


if __name__ == "__main__":
    main()

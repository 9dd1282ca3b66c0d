"""Runs the methods of springfit on every body, scores their networks, and writes results/springfit.json.

    python results.py [--springfit PROGRAM] [--check]

The figures are those of score.py. They are compared with springfit's own; --check compares them with the file and writes nothing.
"""
import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import score

FILE = score.FOLDER / "results" / "springfit.json"
# In percent: two programs solve the same equations.
TOLERANCE = 1e-6
KEYS = ("e_rms", "e_max", "e_tip", "e_energy")


def rows_of(name, program):
    """A row for each fit of a body."""
    body = score.read(score.FOLDER / "reference" / f"{name}.json", "springfit benchmark body")
    with tempfile.TemporaryDirectory() as folder:
        scene = str(score.FOLDER / f"{name}.toml")
        subprocess.run([program, "run", scene, "--out", folder, "-q"], check=True, stdout=subprocess.DEVNULL)
        report = json.loads((Path(folder) / "report.json").read_text())
        fits = {fit["name"]: fit for fit in report["fits"]}
        rows = {}
        for file in Path(folder).glob("*.json"):
            if file.name == "report.json":
                continue
            network = score.read(file, "springfit network")
            fit = network["provenance"]["fit"]
            found = score.score(body, network)
            for load in fits[fit["name"]]["loads"]:
                apart = max(abs(load[key] - found["loads"][load["name"]][key]) for key in KEYS)
                assert apart < TOLERANCE, f"{name}, {fit['name']}, {load['name']}: {apart:.1e} from report.json"
            rows[fit["name"]] = {"body": name, "method": fit["name"], **found}
    return [rows[fit] for fit in fits]


def apart(known, fresh):
    """The largest difference of two lists of rows, in percent."""
    assert [(row["body"], row["method"]) for row in known] == [(row["body"], row["method"]) for row in fresh]
    return max(abs(a["loads"][load][key] - b["loads"][load][key]) for a, b in zip(known, fresh) for load in a["loads"] for key in KEYS)


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--springfit", default="springfit", help="the program")
    arguments.add_argument("--check", action="store_true", help="compare with the file")
    options = arguments.parse_args()
    names = sorted(path.stem for path in score.FOLDER.glob("*.toml"))
    rows = [row for name in names for row in rows_of(name, options.springfit)]
    if options.check:
        difference = apart(json.loads(FILE.read_text())["rows"], rows)
        print(f"{len(rows)} rows; the largest difference is {difference:.1e} percent")
        sys.exit(0 if difference < 1e-3 else 1)
    version = subprocess.run([options.springfit, "--version"], check=True, capture_output=True, text=True).stdout.strip()
    head = {"format": "springfit benchmark results", "version": 1, "program": version, "source": "python results.py"}
    lines = ",\n".join("  " + json.dumps(row) for row in rows)
    FILE.write_text(json.dumps(head)[:-1] + f', "rows": [\n{lines}\n]}}\n')
    print(f"written: {FILE}, {len(rows)} rows")


if __name__ == "__main__":
    main()

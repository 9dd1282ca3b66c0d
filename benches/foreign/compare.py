"""Reads mesh files of others with springfit and with an independent reader, and compares what they find.

    python compare.py --files FILES --springfit PROGRAM [--list files.csv] [--output results.csv] [--limit COUNT]

FILES holds the files of the list under PROJECT/PATH (files.py). Each is read by `springfit groups`, which says cells, points, extent and
groups, and by `springfit fit` with a density of 1, whose masses add up to the volume and which prints notes. readers.py is the other
reader; it runs as a program of its own, so that a crash ends one file. A row of the results has

    outcome      read, or refused
    message      of a refusal; kind is the same without numbers and names
    holds        whether the other reader found a cell of a kind that springfit ships: yes, no, or why it could not tell
    silent       differences that no note of springfit mentions: a note mentions one if it has the number by which they differ
    told         the other differences
    left_out     cells of fewer dimensions than the body that are in no group
    unfitted     why a mesh that was read could not be fitted, so that its volume was not compared

broken.csv beside this script has the files that are damaged or state no body, each with the reason; their refusals are counted apart.
"""
import argparse
import collections
import csv
import json
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from readers import KINDS

FOLDER = Path(__file__).resolve().parent
COLUMNS = ["project", "path", "format", "outcome", "kind", "message", "holds", "cells", "silent", "told", "left_out", "unfitted", "notes"]
FORMATS = {"msh": "Gmsh", "inp": "Abaqus", "bdf": "Nastran", "nas": "Nastran", "dat": "Nastran", "node": "TetGen", "ele": "TetGen",
           "vtk": "legacy VTK", "stl": "STL", "obj": "OBJ", "ply": "PLY", "off": "OFF"}  # fmt: skip
SECONDS = 120
# Relative differences that are none: cells of surfaces are laid into their planes, rules of curved solids are not exact.
VOLUMES = {1: 1e-2, 2: 2e-2, 3: 1e-3}
EXTENT = 1e-6


def run(command):
    """Exit code, output and errors; -1 after SECONDS."""
    try:
        done = subprocess.run(command, capture_output=True, timeout=SECONDS)
    except subprocess.TimeoutExpired:
        return -1, "", f"error: no answer in {SECONDS} s"
    return done.returncode, done.stdout.decode("utf-8", "replace"), done.stderr.decode("utf-8", "replace")


def error(text):
    """The message of an error."""
    lines = text.splitlines()
    at = next((k for k, line in enumerate(lines) if line.startswith("error")), None)
    return " ".join(lines[at:]) if at is not None else " ".join(lines[-1:])


def kind_of(message, path):
    """The message without what belongs to one file."""
    text = message.replace(str(path), "FILE").replace(path.name, "FILE")
    text = re.sub(r"\"[^\"]*\"|`[^`]*`|'[^']*'", "…", text)
    text = re.sub(r"(?i)(?<=INPUT=)[^:]+|(?<=content of )\S+", "…", text)
    text = re.sub(r"(?<![A-Za-z])[-+]?\d[\d.]*([eE][-+]?\d+)?", "#", text)
    return re.sub(r"#(, #)+", "#, #", text)[:200]


def notes_of(text):
    return [line[6:] for line in text.splitlines() if line.startswith("note: ")]


def springfit(program, path):
    """What springfit finds: a record of the groups, or the message; then volume, notes, and why there is no volume."""
    code, output, errors = run([program, "groups", str(path), "--json"])
    if code != 0:
        return None, error(errors) or f"exit code {code}", None, [], ""
    record = json.loads(output)
    notes = notes_of(errors) + record.get("notes", [])
    dimension = max(KINDS[entry["element"]][1] for entry in record["elements"])
    with tempfile.TemporaryDirectory() as folder:
        network = Path(folder) / "network.json"
        command = [program, "fit", str(path), "--young", "10kPa", "--poisson", "0.3", "--density", "1", "--no-errors", "-o", str(network)]
        code, _, errors = run(command + (["--thickness", "1 m"] if dimension == 2 else []))
        notes += notes_of(errors)
        if code != 0:
            return record, "", None, notes, error(errors)
        return record, "", sum(json.loads(network.read_text())["masses"]), notes, ""


def other(path):
    """What the other reader finds, or why it finds nothing."""
    code, output, errors = run([sys.executable, str(FOLDER / "readers.py"), str(path)])
    if code == 0:
        return json.loads(output.splitlines()[-1]), ""
    lines = errors.strip().splitlines()
    return None, (lines[-1] if lines else f"exit code {code}")[:200]


def differences(record, volume, found):
    """Each difference with the numbers of which a note that mentions it has one."""
    ours = collections.Counter()
    for entry in record["elements"]:
        ours[entry["element"]] += entry["cells"]
    for kind in sorted(set(ours) | set(found["body"])):
        here, there = ours[kind], found["body"].get(kind, 0)
        if here != there:
            yield f"{kind}: {here} cells, expected {there}", {abs(here - there), there}
    for kind, count in found["loose"].items():
        yield f"{count} {kind} that lie on no cell of the body are left out", {count}
    if record["points"] != found["points"]:
        yield f"{record['points']} points, expected {found['points']}", {abs(record["points"] - found["points"])}
    here = sorted(record["extent"], reverse=True)
    there = sorted(found["extent"], reverse=True)
    size = max(there, default=0)
    if any(abs(a - b) > EXTENT * size for a, b in zip(here + [0] * 3, there)):
        yield f"extent {here}, expected {there}", set()
    if volume is not None and found["volume"] is not None:
        dimension = found["dimension"]
        if abs(volume - found["volume"]) > VOLUMES.get(dimension, 0) * abs(found["volume"]):
            yield f"volume {volume:.6g}, expected {found['volume']:.6g}", set()
    groups = {group["name"].lower(): group for group in record["groups"]}
    absent = collections.Counter()
    for name, there in found["groups"].items():
        if not any(there.values()):
            continue
        here = groups.get(name.lower())
        if here is None:
            absent[name.split("=")[0]] += 1
            continue
        for what in ("cells", "sides", "points"):
            if there[what] and here[what] != there[what]:
                yield f"group {name}: {here[what]} {what}, expected {there[what]}", {abs(here[what] - there[what])}
    for name, count in absent.items():
        yield f"no group {name}" + (f" ({count} of them)" if count > 1 else ""), set()


def row_of(program, files, entry):
    path = files / entry["project"] / entry["path"]
    record, message, volume, notes, unfitted = springfit(program, path)
    found, trouble = other(path)
    ending = path.suffix[1:].lower()
    row = {"project": entry["project"], "path": entry["path"], "format": FORMATS.get(ending, "VTK XML"), "notes": " | ".join(notes)}
    row["outcome"], row["message"], row["kind"] = ("read", "", "") if record else ("refused", message, kind_of(message, path))
    row["unfitted"] = unfitted
    if found is None:
        row["holds"] = f"unknown: {trouble}"
        return row
    known = {kind: count for kind, count in found["cells"].items() if kind in KINDS}
    row["holds"] = "yes" if known else "no"
    row["cells"] = " ".join(f"{count} {kind}" for kind, count in found["cells"].items())
    if record:
        silent, told = [], []
        numbers = {int(number) for note in notes for number in re.findall(r"\d+", note)}
        for words, mentioned in differences(record, volume, found):
            (told if mentioned & numbers else silent).append(words)
        row["silent"], row["told"] = "; ".join(silent), "; ".join(told)
        grouped = sum(group["sides"] + group["edges"] for group in record["groups"])
        lower = {kind: count for kind, count in found["cells"].items() if kind not in found["body"] and kind not in ("vertex", "Point")}
        if lower and not grouped:
            row["left_out"] = " ".join(f"{count} {kind}" for kind, count in lower.items())
    return row


def summary(rows, broken):
    """The tables at the end."""

    def is_body(row):
        return row["holds"] == "yes" and (row["project"], row["path"]) not in broken

    heads = ["files", "read", "refused", "broken", "with a body", "of them refused", "silent differences", "unchecked"]
    widths = [max(7, len(head) + 2) for head in heads]
    print(f"\n{'format':12}" + "".join(f"{head:>{width}}" for head, width in zip(heads, widths)))
    for name in [*sorted({row["format"] for row in rows}), "all"]:
        of = [row for row in rows if name in ("all", row["format"])]
        refused = [row for row in of if row["outcome"] == "refused"]
        counts = [len(of), len(of) - len(refused), len(refused), sum((row["project"], row["path"]) in broken for row in refused),
                  sum(map(is_body, of)), sum(map(is_body, refused)), sum(bool(row.get("silent")) for row in of),
                  sum(row["holds"].startswith("unknown") for row in of)]  # fmt: skip
        print(f"{name:12}" + "".join(f"{count:>{width}}" for count, width in zip(counts, widths)))
    bodies, refused = sum(map(is_body, rows)), [row for row in rows if row["outcome"] == "refused" and is_body(row)]
    print(f"\n{len(refused)} of {bodies} files with a body are refused, {100 * len(refused) / max(bodies, 1):.1f} %")
    kinds = collections.Counter((row["format"], row["kind"]) for row in refused)
    for (name, kind), count in kinds.most_common():
        print(f"{count:5}  {name}: {kind}")
    print("\nbroken files by reason")
    reasons = collections.Counter(broken[row["project"], row["path"]] for row in rows if (row["project"], row["path"]) in broken)
    for reason, count in reasons.most_common():
        print(f"{count:5}  {reason}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--files", type=Path, required=True, help="the folder of the files")
    parser.add_argument("--springfit", default="springfit", help="the program")
    parser.add_argument("--list", type=Path, default=FOLDER / "files.csv", help="which files")
    parser.add_argument("--output", type=Path, default=Path("results.csv"), help="where the rows go")
    parser.add_argument("--limit", type=int, help="only so many files, spread over the list")
    parser.add_argument("--jobs", type=int, default=2, help="how many at once")
    options = parser.parse_args()
    entries = [entry for entry in csv.DictReader(options.list.open()) if entry["role"] == "mesh"]
    entries.sort(key=lambda entry: entry["sha256"])
    entries = entries[: options.limit]
    rows = []
    with options.output.open("w", newline="") as file, ThreadPoolExecutor(options.jobs) as pool:
        table = csv.DictWriter(file, COLUMNS, restval="", lineterminator="\n")
        table.writeheader()
        for row in pool.map(lambda entry: row_of(options.springfit, options.files, entry), entries):
            rows.append(row)
            table.writerow(row)
            file.flush()
    broken = {(row["project"], row["path"]): row["reason"] for row in csv.DictReader((FOLDER / "broken.csv").open())}
    summary(rows, broken)


if __name__ == "__main__":
    main()

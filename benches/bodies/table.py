"""The table of the book: all rows of results/*.json.

    python table.py              print it
    python table.py --write      put it into the page, docs/src/studies/benchmark.md
"""
import json
import sys

import score

PAGE = score.FOLDER.parents[1] / "docs/src/studies/benchmark.md"
BEGIN, END = "<!-- written by benches/bodies/table.py -->\n", "<!-- end -->"


def table():
    rows = [row for file in sorted((score.FOLDER / "results").glob("*.json")) for row in json.loads(file.read_text())["rows"]]
    bodies = sorted({row["body"] for row in rows})
    methods = list(dict.fromkeys(row["method"] for row in rows))
    cells = {(row["method"], row["body"]): row for row in rows}
    lines = ["| method | " + " | ".join(bodies) + " |", "|---" * (len(bodies) + 1) + "|"]
    for method in methods:
        entries = []
        for body in bodies:
            row = cells.get((method, body))
            figures = "–" if row is None else " / ".join(f"{load['e_rms']:.2f}" for load in row["loads"].values())
            entries.append(figures + (" †" if row is not None and not row["definite"] else ""))
        lines.append(f"| {method} | " + " | ".join(entries) + " |")
    return "\n".join(lines) + "\n"


def of_page():
    """The page before, in and after the table."""
    before, rest = PAGE.read_text().split(BEGIN)
    inside, after = rest.split(END, 1)
    return before, inside, after


if __name__ == "__main__":
    if sys.argv[1:] == ["--write"]:
        before, _, after = of_page()
        PAGE.write_text(before + BEGIN + table() + END + after)
    else:
        print(table(), end="")

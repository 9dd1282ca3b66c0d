"""The tables of the book, one for each load: all rows of results/*.json.

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
    parts = []
    for load in rows[0]["loads"]:
        lines = [f"| {load} | " + " | ".join(f"`{body}`" for body in bodies) + " |", "|---" * (len(bodies) + 1) + "|"]
        for method in methods:
            entries = [entry(cells.get((method, body)), load) for body in bodies]
            lines.append(f"| {method} | " + " | ".join(entries) + " |")
        parts.append("\n".join(lines) + "\n")
    return "\n".join(parts)


def entry(row, load):
    return "–" if row is None else f"{row['loads'][load]['e_rms']:.2f}" + ("" if row["definite"] else " †")


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

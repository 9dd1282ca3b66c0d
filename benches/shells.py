"""The roof of Scordelis and Lo and the hemisphere with a hole by the six-node shells S6 of CalculiX, with the nodes of the table of shells.

    apt-get install calculix-ccx
    python benches/shells.py

Prints the deflections over 0.3024 and 0.0924 for 8, 16 and 32 cells of three nodes along a side of a quarter, so that a shell S6 has the place of four of
them. Shells are whole, because CalculiX holds rotations on planes of symmetry by rigid bodies, which are too stiff.
"""
import math
import subprocess
import tempfile
from pathlib import Path

SIZES = (8, 16, 32)


def deck(across, along, is_closed, place, material, thickness, boundary, loads, watched):
    """The input of CalculiX for a sheet of across x along squares of two triangles S6, of which `place` gives the nodes of the grid of half the size."""
    columns = 2 * across + (0 if is_closed else 1)
    number = lambda i, j: 1 + i % columns + columns * j
    lines = ["*NODE, NSET=ALL"]
    for j in range(2 * along + 1):
        lines += [f"{number(i, j)}, " + ", ".join(f"{x:.14g}" for x in place(i, j)) for i in range(columns)]
    lines.append("*ELEMENT, TYPE=S6, ELSET=SHELL")
    count = 0
    for j in range(0, 2 * along, 2):
        for i in range(0, 2 * across, 2):
            for corners in [((0, 0), (2, 0), (0, 2)), ((2, 0), (2, 2), (0, 2))]:
                count += 1
                middles = [tuple((a + b) // 2 for a, b in zip(corners[k], corners[(k + 1) % 3])) for k in range(3)]
                lines.append(f"{count}, " + ", ".join(str(number(i + a, j + b)) for a, b in [*corners, *middles]))
    young, poisson, density = material
    lines += ["*MATERIAL, NAME=M", "*ELASTIC", f"{young}, {poisson}", "*DENSITY", f"{density}"]
    lines += ["*SHELL SECTION, ELSET=SHELL, MATERIAL=M", f"{thickness}", "*BOUNDARY"]
    lines += [f"{number(i, j)}, {axis}, {axis}" for i, j, axis in boundary]
    lines += ["*STEP", "*STATIC", *loads(number), f"*NSET, NSET=WATCHED\n{number(*watched)}"]
    lines += ["*NODE PRINT, NSET=WATCHED", "U", "*END STEP"]
    return "\n".join(lines) + "\n"


def displacement(text):
    """The displacement of the node that is watched."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "shell.inp").write_text(text)
        made = subprocess.run(["ccx", "shell"], cwd=folder, capture_output=True, text=True)
        printed = Path(folder) / "shell.dat"
        if made.returncode or not printed.exists():
            raise SystemExit(made.stdout[-2000:] + made.stderr)
        return [float(word) for word in printed.read_text().split("\n")[3].split()[1:]]


def roof(n):
    """A whole roof; n is even, and the middle of a free side is watched."""

    def place(i, j):
        angle = math.radians(40) * (j / n - 1)
        return 25 * (i / n - 1), 25 * math.sin(angle), 25 * math.cos(angle)

    ends = [(i, j, axis) for i in (0, 2 * n) for j in range(2 * n + 1) for axis in (2, 3)]
    gravity = lambda number: ["*DLOAD", "SHELL, GRAV, 1., 0., 0., -1."]
    text = deck(n, n, False, place, (4.32e8, 0.0, 360.0), 0.25, [*ends, (n, n, 1)], gravity, (n, 0))
    return -displacement(text)[2] / 0.3024


def hemisphere(n):
    """A whole hemisphere with a hole of 18 degrees; forces of 2 at four points of its rim pull and push in turn."""

    def place(i, j):
        around, up = math.pi / 2 * i / n, math.radians(72) * j / n
        return 10 * math.cos(up) * math.cos(around), 10 * math.cos(up) * math.sin(around), 10 * math.sin(up)

    rim = [(0, 0, 2), (2 * n, 0, 2), (n, 0, 1), *((i, 0, 3) for i in (n // 2, n // 2 + n, n // 2 + 2 * n))]
    forces = [(0, 1, 2), (2 * n, 1, -2), (n, 2, -2), (3 * n, 2, 2)]
    loads = lambda number: ["*CLOAD", *(f"{number(i, 0)}, {axis}, {force}" for i, axis, force in forces)]
    text = deck(2 * n, n // 2, True, place, (6.825e7, 0.3, 1.0), 0.04, rim, loads, (0, 0))
    return displacement(text)[0] / 0.0924


if __name__ == "__main__":
    print("| shell | n = 8 | 16 | 32 |\n|---|---|---|---|")
    for shell in (roof, hemisphere):
        print(f"| {shell.__name__} | " + " | ".join(f"{shell(n):.3f}" for n in SIZES) + " |", flush=True)

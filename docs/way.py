"""Draws the way from a scan to an engine, docs/src/figures/way.webp: python docs/way.py SPRINGFIT OUT.webp.

Needs NumPy, Matplotlib, Pillow and MuJoCo. The surface of scenes/meshes/kidney_hex.msh stands for a scan; all else is what the program and the
engine make of it.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

MESH = pathlib.Path(__file__).resolve().parent.parent / "scenes/meshes/kidney_hex.msh"
MATERIAL = ["--scale", "mm", "--young", "60kPa", "--poisson", "0.45"]
SCENE = """
[mesh]
fill  = { surface = "kidney.stl", cell = 9, element = "tet4", boundary = "smooth" }
scale = "mm"
[material]
young   = "60 kPa"
poisson = 0.45
density = 1050
[[fix]]
where = "x < -0.042"
[[fit]]
objective   = "divergence"
springs     = ["edge", "bulk"]
nonnegative = true
"""
# Shades of a triangle that looks away from the light, and towards it.
SHADES = 0.45, 1.0
LIGHT = np.array([-0.4, -0.7, 0.6]) / np.linalg.norm([-0.4, -0.7, 0.6])


def run(*command, folder):
    subprocess.run([str(word) for word in command], cwd=folder, check=True, stdout=subprocess.DEVNULL)


def network(path):
    """Points in mm, triangles of the surface, the ends of the springs on lengths, and their constants."""
    record = json.loads(path.read_text())
    lengths = [spring for spring in record["springs"] if spring["kind"] == "length"]
    ends = np.array([spring["points"] for spring in lengths])
    return 1e3 * np.array(record["points"]), np.array(record["surface"]), ends, np.array([spring["constant"] for spring in lengths])


def write_stl(path, points, triangles):
    lines = ["solid kidney"]
    for triangle in points[triangles]:
        lines += ["facet normal 0 0 0", "outer loop", *(f"vertex {x} {y} {z}" for x, y, z in triangle), "endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid kidney", ""]))


def shaded(axes, points, triangles, color, edges):
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    shade = SHADES[0] + (SHADES[1] - SHADES[0]) * (0.5 + 0.5 * normals @ LIGHT)
    faces = np.clip(shade[:, None] * np.array(matplotlib.colors.to_rgb(color)), 0, 1)
    axes.add_collection3d(Poly3DCollection(corners, facecolors=faces, edgecolors=edges or faces, linewidths=0.4))


def sprung(axes, points, ends, constants):
    norm = matplotlib.colors.Normalize(0, np.percentile(constants, 95))
    colors = matplotlib.colormaps["viridis"](norm(constants))
    axes.add_collection3d(Line3DCollection(points[ends], colors=colors, linewidths=0.7))


def main():
    springfit, out = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        run(springfit, "fit", MESH, *MATERIAL, "--no-errors", "-o", "scan.json", folder=folder)
        scan, scanned, _, _ = network(folder / "scan.json")
        write_stl(folder / "kidney.stl", scan, scanned)
        (folder / "kidney.toml").write_text(SCENE)
        run(springfit, "run", "kidney.toml", "--out", "out", folder=folder)
        points, triangles, ends, constants = network(next(path for path in (folder / "out").glob("*.json") if path.name != "report.json"))
        run(springfit, "export", "kidney.toml", "--to", "mujoco", "--gravity", "0,0,-9.81", "--out", "engine", folder=folder)
        run(sys.executable, "run.py", "--rest", "rest.npy", folder=folder / "engine")
        rest = 1e3 * np.load(folder / "engine/rest.npy").reshape(-1, 3)
    plt.rcParams["font.family"] = "DejaVu Sans"
    figure = plt.figure(figsize=(12.8, 2.9))
    panels = [
        ("scan", lambda axes: shaded(axes, scan, scanned, "#c98f7a", None)),
        (f"{len(points)} points", lambda axes: shaded(axes, points, triangles, "#c9b48f", "#5a4a30")),
        (f"{len(ends)} springs", lambda axes: sprung(axes, points, ends, constants)),
        ("in MuJoCo, held at its left end", lambda axes: (sprung(axes, rest, ends, constants), shaded(axes, rest, triangles, "#7aa6c9", None))),
    ]
    everything = np.concatenate([points, rest])
    low, high = everything.min(axis=0), everything.max(axis=0)
    for place, (title, draw) in enumerate(panels):
        axes = figure.add_axes((0.25 * place + 0.01, -0.06, 0.23, 1.2), projection="3d")
        draw(axes)
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
        axes.set_box_aspect(high - low, zoom=1.2)
        axes.view_init(elev=22, azim=-66)
        axes.set_axis_off()
        figure.text(0.125 + 0.25 * place, 0.05, title, ha="center", fontsize=13)
        if place:
            figure.text(0.25 * place + 0.003, 0.58, "→", ha="center", va="center", fontsize=24, color="#555555")
    figure.savefig(out, dpi=110, facecolor="white", pil_kwargs={"quality": 82, "method": 6})


if __name__ == "__main__":
    main()

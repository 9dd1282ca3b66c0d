"""What a coarse network gains that is fitted to a fine body: median and largest error of thirty loads that no fit has seen, for each
support, as geometric means over the seeds of the loads; and the frequencies of networks whose masses are fitted to the first six.

Usage: pip install gmsh; python benches/coarse.py [--springfit target/release/springfit] [--seeds 5] [--bodies cantilever,...]
"""

import argparse
import json
import subprocess
import tempfile
from pathlib import Path
from statistics import geometric_mean

import gmsh

# Sizes of the cells in metres, coarse and fine; groups of points that are held in training, and one that is not.
BODIES = {
    "cantilever, nu 0.3": ("bar", 0.3, 0.45, 0.13),
    "cantilever, nu 0.49": ("bar", 0.49, 0.45, 0.13),
    "block with a hole, nu 0.3": ("hole", 0.3, 0.4, 0.12),
    "organ-like, nu 0.45": ("organ", 0.45, 0.3, 0.1),
}
SCENE = """
[mesh]
file = "coarse.msh"
[material]
young = "5 kPa"
poisson = {poisson}
density = 1000
[reference]
mesh = {{ file = "fine.msh" }}
[[fit]]
name = "moduli"
objective = "whole"
start = "exact"
volume = "patches"
supports = [["left"], ["left", "right"]]
validate_supports = [["bottom"]]
masses = 6
seed = {seed}
[[fit]]
name = "one support"
objective = "whole"
start = "exact"
volume = "patches"
masses = 6
seed = {seed}
[[fix]]
group = "left"
"""


def shape(kind):
    """The solid of a body; its sides are the faces and, of the organ, caps cut flat."""
    occ = gmsh.model.occ
    if kind == "bar":
        occ.addBox(0, 0, 0, 4, 1, 1)
    elif kind == "hole":
        box, hole = occ.addBox(0, 0, 0, 2, 2, 1), occ.addCylinder(1, 1, 0, 0, 0, 1, 0.5)
        occ.cut([(3, box)], [(3, hole)])
    else:
        ball, bump = occ.addSphere(0, 0, 0, 1.2), occ.addSphere(0.9, 0.4, 0.1, 0.76)
        occ.dilate([(3, ball)], 0, 0, 0, 1, 0.6, 0.45)
        occ.dilate([(3, bump)], 0.9, 0.4, 0.1, 1, 0.7, 0.8)
        joined, _ = occ.fuse([(3, ball)], [(3, bump)])
        occ.intersect(joined, [(3, occ.addBox(-1, -1, -0.4, 2.4, 2, 2))])
    occ.synchronize()


def mesh(kind, size, order, path):
    """A mesh of the body with the groups left, right and bottom; returns its number of points."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    shape(kind)
    planes = [tag for _, tag in gmsh.model.getEntities(2) if gmsh.model.getType(2, tag) == "Plane"]
    for name, axis, farthest in [("left", 0, min), ("right", 0, max), ("bottom", 2, min)]:
        along = {tag: gmsh.model.occ.getCenterOfMass(2, tag)[axis] for tag in planes}
        end = farthest(along.values())
        gmsh.model.addPhysicalGroup(2, [tag for tag in planes if abs(along[tag] - end) < 1e-6], name=name)
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)], name="body")
    gmsh.option.setNumber("Mesh.MeshSizeMin", size)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(order)
    gmsh.write(str(path))
    points = len(gmsh.model.mesh.getNodes()[0])
    gmsh.finalize()
    return points


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--springfit", default="target/release/springfit")
    options.add_argument("--seeds", type=int, default=5)
    options.add_argument("--bodies", default=";".join(BODIES), help="names, separated by semicolons")
    options = options.parse_args()
    springfit = Path(options.springfit).resolve()
    print("body | points coarse / fine | fit | support | finite elements: median (largest) % | fitted: median (largest) % | gain")
    for name in options.bodies.split(";"):
        kind, poisson, coarse, fine = BODIES[name]
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            points = mesh(kind, coarse, 1, folder / "coarse.msh"), mesh(kind, fine, 2, folder / "fine.msh")
            found, vibrating = {}, {}
            for seed in range(1, options.seeds + 1):
                (folder / "scene.toml").write_text(SCENE.format(poisson=poisson, seed=seed))
                subprocess.run([springfit, "run", "scene.toml", "--out", "out", "-q"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
                report = json.loads((folder / "out/report.json").read_text())
                for fit in report["fits"]:
                    for held in fit["whole"]["held_out"]:
                        models = {model["model"]: model for model in held["models"]}
                        key = fit["name"], held["support"] + ("" if held["trained"] else ", not fitted")
                        found.setdefault(key, []).append([models[m][k] for m in ("finite elements", "fitted") for k in ("median", "worst")])
                    for held in fit["whole"]["masses"]["supports"]:
                        models = {model["model"]: model for model in held["models"]}
                        key = fit["name"], held["support"] + ("" if held["trained"] else ", not fitted")
                        vibrating.setdefault(key, []).append([models[m][k] for m in ("finite elements", "fitted masses") for k in ("first", "next")])
            for (fit, support), rows in found.items():
                body, worst_body, own, worst = (100 * geometric_mean(column) for column in zip(*rows))
                print(f"{name} | {points[0]} / {points[1]} | {fit} | {support} | {body:.2f} ({worst_body:.1f}) | {own:.2f} ({worst:.1f}) | {body / own:.1f}", flush=True)
            for (fit, support), rows in vibrating.items():
                first, following, own, next_own = (100 * geometric_mean(column) for column in zip(*rows))
                print(f"{name} | {points[0]} / {points[1]} | {fit} | {support} | frequencies 1 to 6 / 7 to 12: {first:.1f} / {following:.1f} | {own:.1f} / {next_own:.1f} | {following / next_own:.1f}", flush=True)


if __name__ == "__main__":
    main()

"""What a coarse network gains that is fitted to a fine body: median and largest error in percent of thirty loads that no fit has seen, for
each support, as geometric means over the seeds of the loads; and the frequencies of networks whose masses, and whose mass matrix, are fitted to the first six.
The rows of each support are the finite elements of the coarse mesh, its exact networks with patches and with edges and patches, and the
fitted network, with the gain over the finite elements and the loads, of all seeds, that are worse by more than a tenth.

Usage: pip install gmsh; python benches/coarse.py [--springfit target/release/springfit] [--seeds 5] [--fine 1] [--coarse 1] [--bodies "cantilever, nu 0.3;..."]
"""

import argparse
import json
import subprocess
import tempfile
from pathlib import Path
from statistics import geometric_mean

import gmsh

# The shape, Poisson's ratio, and the sizes of the cells in metres, coarse and fine. No rule and no setting of the program was chosen with a
# look at the last two bodies.
BODIES = {
    "cantilever, nu 0.3": ("bar", 0.3, 0.45, 0.082),
    "cantilever, nu 0.49": ("bar", 0.49, 0.45, 0.082),
    "block with a hole, nu 0.3": ("hole", 0.3, 0.4, 0.077),
    "organ-like, nu 0.45": ("organ", 0.45, 0.3, 0.069),
    "bracket, nu 0.35": ("bracket", 0.35, 0.35, 0.079),
    "tube, nu 0.4": ("tube", 0.4, 0.4, 0.105),
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
# Far below the errors that are compared.
[solver]
tolerance = 1e-9
[[fix]]
group = "left"
"""
# All seeds are fits of one scene, so that the fine body is factorised once for each support.
FIT = """
[[fit]]
name = "{name} {seed}"
objective = "whole"
start = "exact"
shear = "edges"
volume = "patches"
masses = 6
seed = {seed}
{keys}
"""
FITS = {
    "three supports": """supports = [["left"], ["left", "right"]]
validate_supports = [["left"], ["left", "right"], ["bottom"]]
other_supports = [["right"]]""",
    "one support": 'supports = [["left"]]',
    "both ends alone": 'supports = [["left", "right"]]',
}
MODELS = ["finite elements", "exact patches", "exact edges patches", "fitted"]
# What is fitted to frequencies.
MASSES = ["fitted masses", "mass matrix"]


def shape(kind):
    """The solid of a body; its sides are the faces and, of the organ, caps cut flat."""
    occ = gmsh.model.occ
    if kind == "bar":
        occ.addBox(0, 0, 0, 4, 1, 1)
    elif kind == "hole":
        box, hole = occ.addBox(0, 0, 0, 2, 2, 1), occ.addCylinder(1, 1, 0, 0, 0, 1, 0.5)
        occ.cut([(3, box)], [(3, hole)])
    elif kind == "bracket":
        occ.fuse([(3, occ.addBox(0, 0, 0, 0.8, 1, 2.4))], [(3, occ.addBox(0, 0, 0, 3, 1, 0.7))])
    elif kind == "tube":
        # Cut flat below, so that it has a bottom.
        tube, bore = occ.addCylinder(0, 0, 0, 4, 0, 0, 1), occ.addCylinder(0, 0, 0, 4, 0, 0, 0.55)
        tube, _ = occ.cut([(3, tube)], [(3, bore)])
        occ.intersect(tube, [(3, occ.addBox(0, -1, -0.85, 4, 2, 2))])
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


def percent(median, worst):
    return f"{100 * geometric_mean(median):.2f} ({100 * geometric_mean(worst):.1f})"


def part(held):
    """What loads and frequencies under a support were for."""
    return "" if held["trained"] else ", chooses rho" if held["chooses"] else ", unseen"


def rows(report):
    """The table of one body: errors under loads for each fit and support, and errors of frequencies."""
    held_out, vibrating = {}, {}
    for fit in report["fits"]:
        name = fit["name"].rsplit(" ", 1)[0]
        for held in fit["whole"]["held_out"]:
            held_out.setdefault((name, held["support"], part(held)), []).append((fit["name"], held))
        for held in fit["whole"]["masses"]["supports"]:
            vibrating.setdefault((name, held["support"], part(held)), []).append(held)
    for (name, support, seen), found in held_out.items():
        models = {m: [next(row for row in held["models"] if row["model"] == m) for _, held in found] for m in MODELS}
        cells = [percent([row["median"] for row in models[m]], [row["worst"] for row in models[m]]) for m in MODELS]
        gains = [body["median"] / own["median"] for body, own in zip(models[MODELS[0]], models[MODELS[-1]])]
        worse = [
            f"{load['load']} of seed {fit.rsplit(' ', 1)[1]}: {100 * load['finite_elements']:.1f} to {100 * load['fitted']:.1f}"
            for fit, held in found
            for load in held["worse_than_finite_elements"]
        ]
        yield f"{name} | {support}{seen} | {' | '.join(cells)} | {geometric_mean(gains):.1f} | {len(worse)} of {sum(held['loads'] for _, held in found)}" + (
            f" ({'; '.join(worse)})" if worse else ""
        )
    for (name, support, seen), found in vibrating.items():
        models = {m: [next(row for row in held["models"] if row["model"] == m) for held in found] for m in (MODELS[0], *MASSES)}
        cells = [
            f"{100 * geometric_mean([row['first'] for row in of]):.2f} / {100 * geometric_mean([row['next'] for row in of]):.2f}" for of in models.values()
        ]
        gains = [geometric_mean([body["next"] / own["next"] for body, own in zip(models[MODELS[0]], models[of])]) for of in MASSES]
        yield f"{name} | {support}{seen} | frequencies 1 to 6 / 7 to 12: {cells[0]} | | {cells[1]} | {cells[2]} | {' and '.join(f'{gain:.1f}' for gain in gains)} | "


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--springfit", default="target/release/springfit")
    options.add_argument("--seeds", type=int, default=5)
    options.add_argument("--fine", type=float, default=1.0, help="size of the fine cells relative to that of the table; 1.5 takes a quarter of the time")
    options.add_argument("--coarse", type=float, default=1.0, help="the same for the coarse cells; 0.57 gives three times as many points or more")
    options.add_argument("--bodies", default=";".join(BODIES), help="names, separated by semicolons")
    options = options.parse_args()
    springfit = Path(options.springfit).resolve()
    print(f"| body | points coarse / fine | fit | held | {' | '.join(MODELS)} | gain | worse by more than a tenth |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for name in options.bodies.split(";"):
        kind, poisson, coarse, fine = BODIES[name]
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            points = mesh(kind, options.coarse * coarse, 1, folder / "coarse.msh"), mesh(kind, options.fine * fine, 2, folder / "fine.msh")
            scene = SCENE.format(poisson=poisson)
            for seed in range(1, options.seeds + 1):
                scene += "".join(FIT.format(name=fit, seed=seed, keys=keys) for fit, keys in FITS.items())
            (folder / "scene.toml").write_text(scene)
            subprocess.run([springfit, "run", "scene.toml", "--out", "out", "-q"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
            report = json.loads((folder / "out/report.json").read_text())
            for row in rows(report):
                print(f"| {name} | {points[0]} / {points[1]} | {row} |", flush=True)


if __name__ == "__main__":
    main()

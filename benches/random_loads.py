"""What a fit to the whole object gains over fits of single elements, under thirty random loads that no fit has seen: median and largest error
for each body, as geometric means over the seeds of the loads.

Usage: python benches/random_loads.py [--springfit target/release/springfit] [--seeds 3]
"""

import argparse
import json
import subprocess
import tempfile
from pathlib import Path
from statistics import geometric_mean

ROOT = Path(__file__).resolve().parent.parent
# What a scene has for a body, and the group that is held.
BODIES = {
    "tissue_quad": (f'file = "{ROOT}/scenes/meshes/tissue_quad.msh"\nscale = 0.01', "thickness = 0.01", "fixed"),
    "cube_hex": ('scale = 0.01\nbox = { element = "hex8", size = [2, 2, 2], cells = [8, 8, 8] }', "", "zmin"),
    "cube_tet": (f'file = "{ROOT}/scenes/meshes/cube_tet.msh"\nscale = 0.01', "", "fixed"),
    "cylinder_hole_tet": (f'file = "{ROOT}/scenes/meshes/cylinder_hole_tet.msh"\nscale = 0.01', "", "fixed"),
}
SCENE = """
[mesh]
{mesh}
[material]
young = "10 kPa"
poisson = 0.3
{material}
[[fit]]
name = "whole"
objective = "whole"
start = "offdiag"
supports = [["{held}"]]
seed = {seed}
[[fix]]
group = "{held}"
"""


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--springfit", default="target/release/springfit")
    options.add_argument("--seeds", type=int, default=3)
    options = options.parse_args()
    springfit = Path(options.springfit).resolve()
    gains = []
    print("body | single elements: median (largest) % | whole object: median (largest) % | gain")
    for name, (mesh, material, held) in BODIES.items():
        rows = []
        for seed in range(1, options.seeds + 1):
            with tempfile.TemporaryDirectory() as folder:
                scene = Path(folder) / "scene.toml"
                scene.write_text(SCENE.format(mesh=mesh, material=material, held=held, seed=seed))
                subprocess.run([springfit, "run", scene, "--out", folder + "/out", "-q"], check=True, stdout=subprocess.DEVNULL)
                report = json.loads(Path(folder, "out/report.json").read_text())
            models = {model["model"]: model for model in report["fits"][0]["whole"]["held_out"][0]["models"]}
            rows.append([models[model][error] for model in ("start", "fitted") for error in ("median", "worst")])
        start, worst_start, own, worst = (100 * geometric_mean(column) for column in zip(*rows))
        gains.append(start / own)
        print(f"{name} | {start:.2f} ({worst_start:.1f}) | {own:.2f} ({worst:.1f}) | {start / own:.1f}", flush=True)
    print(f"geometric mean of the gains: {geometric_mean(gains):.1f}")


if __name__ == "__main__":
    main()

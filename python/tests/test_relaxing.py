"""Stress that relaxes: the loop in NumPy that `export` writes against the program."""

import json
import subprocess
import sys

import numpy as np
import pytest

SCENE = """
[mesh]
box = { element = "tet4", size = [0.1, 0.1, 0.2], cells = [2, 2, 4] }
[material]
young = 10e3
poisson = 0.3
density = 1000
law = "stable-neo-hookean"
relaxation = { terms = [{ shear = 0.5, time = "20 ms" }, { shear = 0.2, time = "0.2 s" }] }
[[fit]]
objective = "exact"
[[fix]]
group = "zmin"
[motion]
duration = 0.3
step = 2e-4
every = 0.1
integrator = "symplectic-euler"
gravity = [3, 0, -9.81]
watch = { group = "zmax" }
"""


def springfit(*arguments, cwd):
    return subprocess.run([sys.executable, "-m", "springfit", *arguments], cwd=cwd, capture_output=True, text=True)


def test_the_loop_in_numpy_moves_as_the_program(tmp_path):
    (tmp_path / "bar.toml").write_text(SCENE)
    assert springfit("run", "bar.toml", "--out", "out", cwd=tmp_path).returncode == 0
    assert springfit("export", "bar.toml", "--to", "npz", "--out", "npz", cwd=tmp_path).returncode == 0
    run = subprocess.run([sys.executable, "npz/run.py", "--time", "0.3", "--step", "2e-4"], cwd=tmp_path, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    found = np.load(tmp_path / "npz/positions.npy")
    points = np.load(tmp_path / "npz/network.npz")["points"]
    top = points[:, 2] > 0.2 - 1e-9
    motion = json.loads((tmp_path / "out/report.json").read_text())["motion"]
    expected = next(model for model in motion if model["name"] == "exact")["watched"][-1]
    # The largest displacement is 0.15 m; the two add up in another order.
    assert np.allclose((found - points)[top].mean(0), expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize("program", ["mujoco", "lammps", "sofa", "jolt", "phystwin"])
def test_other_programs_are_refused(tmp_path, program):
    (tmp_path / "bar.toml").write_text(SCENE)
    refused = springfit("export", "bar.toml", "--to", program, "--out", "out", cwd=tmp_path)
    assert refused.returncode == 2 and "relaxes in 2 terms" in refused.stderr
    assert not (tmp_path / "out").exists()


def test_constraints_do_not_hold_shear_alone(tmp_path):
    (tmp_path / "bar.toml").write_text(SCENE)
    refused = springfit("export", "bar.toml", "--to", "xpbd", "--out", "out", cwd=tmp_path)
    assert refused.returncode == 2 and "shares of shear and bulk that are alike, found shear = 0.5, bulk = 0" in refused.stderr


def test_the_loop_says_what_it_does_not_serve(tmp_path):
    (tmp_path / "bar.toml").write_text(SCENE.replace("shear = 0.2,", 'shear = 0.2, yield = "300 Pa",'))
    assert springfit("export", "bar.toml", "--to", "npz", "--out", "npz", cwd=tmp_path).returncode == 0
    run = subprocess.run([sys.executable, "npz/run.py"], cwd=tmp_path, capture_output=True, text=True)
    assert run.returncode == 1 and "found a yield stress" in run.stderr

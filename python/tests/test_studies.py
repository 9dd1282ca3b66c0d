"""Fits to forces and to whole objects, exports, and the studies of the command."""

import json
import os
import subprocess

import numpy as np
import pytest

import springfit as sf
from conftest import raised, square

MATERIAL = sf.Material(young=1e4, poisson=0.3)
SCENE = square(2)


def box():
    return sf.Mesh.box("tri3", size=[1.0, 1.0], cells=[2, 2])


def test_sampled_fits_are_those_of_a_scene():
    shapes = {"count": 20, "stretch": 0.2}
    net = sf.sampled(box(), MATERIAL, "neo-hookean", shapes=shapes)
    other = sf.fit(box(), MATERIAL, "sampled", law="neo-hookean", shapes=shapes)
    assert np.array_equal(net.constants, other.constants) and len(net) > 0
    with pytest.raises(sf.SpringfitError) as error:
        sf.sampled(box(), MATERIAL, "nobody")
    assert "nobody" in str(error.value)


def test_whole_object_fits_take_what_is_held():
    net = sf.whole(box(), MATERIAL, fix="ymin")
    assert len(net) > 0 and net.constants.min() > -1e30
    flags = np.zeros(len(box().points), bool)
    flags[box().groups["ymin"]] = True
    assert np.array_equal(sf.whole(box(), MATERIAL, fix=flags).constants, net.constants)
    for call, key in [
        (lambda: sf.whole(box(), MATERIAL, fix="left"), "fix"),
        (lambda: sf.whole(box(), MATERIAL, fix=None), "fix"),
        (lambda: sf.fit(box(), MATERIAL, "exact", fix="ymin"), "fix"),
        (lambda: sf.fit(box(), MATERIAL, "whole", fix=[99]), "fix"),
    ]:
        raised(call, key)


def test_exports_are_those_of_the_command(tmp_path):
    mesh = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[2, 2, 2])
    net = sf.fit(mesh, sf.Material(1e4, 0.3, density=1000.0), "offdiag", nonnegative=True)
    files = net.export("npz", tmp_path / "arrays", gravity=[0, 0, -1])
    assert files and all(file.exists() for file in files)
    command = os.environ.get("SPRINGFIT")
    if command is not None:
        net.write(tmp_path / "net.json")
        arguments = ["export", "net.json", "--to", "npz", "--gravity", "0 0 -1", "--out", "theirs"]
        subprocess.run([command, *arguments], cwd=tmp_path, check=True, capture_output=True)
        # The list of the files is hidden.
        found = [name for name in os.listdir(tmp_path / "theirs") if not name.startswith(".")]
        assert sorted(found) == sorted(file.name for file in files)
        for file in files:
            assert file.read_bytes() == (tmp_path / "theirs" / file.name).read_bytes() or file.suffix == ".npz"
        ours, theirs = (np.load(next(f for f in folder.iterdir() if f.suffix == ".npz")) for folder in (tmp_path / "arrays", tmp_path / "theirs"))
        assert sorted(ours) == sorted(theirs)
        for name in ours:
            assert np.array_equal(ours[name], theirs[name], equal_nan=ours[name].dtype.kind == "f"), name
    for to, gravity, key in [("nobody", None, "to"), ("lammps", [1.0], "gravity"), ("npz", ["x"], None)]:
        with pytest.raises(ValueError) as error:
            net.export(to, tmp_path / "none", gravity=gravity)
        assert key is None or error.value.key == key, str(error.value)
    assert not (tmp_path / "none").exists()


def test_comparisons_of_scenes_have_all_fits():
    pytest.importorskip("pandas")
    report = sf.compare(SCENE)
    assert len(report.fits) > 5 and report.loads["e_rms"].notna().any()


def test_studies_of_scenes_are_those_of_the_command(tmp_path, command):
    found = sf.converge(SCENE, levels=2)
    scene = tmp_path / "scene.toml"
    scene.write_text(
        '[mesh]\nbox = { element = "quad4", size = [1, 1], cells = [2, 2] }\n[material]\nyoung = 1e4\npoisson = 0.3\n'
        '[[fix]]\ngroup = "ymin"\n[[load]]\nname = "tension"\ngroup = "ymax"\ntraction = [0, 100]\n'
        '[[fit]]\nobjective = "frobenius"\n[[fit]]\nobjective = "exact"\n'
    )
    arguments = ["converge", str(scene), "--levels", "2", "--json", "--out", str(tmp_path / "out")]
    made = subprocess.run([command, *arguments], check=True, capture_output=True)
    assert timeless(json.loads(made.stdout)) == timeless(sf.converge(scene, levels=2))
    assert timeless(found)["loads"] == timeless(json.loads(made.stdout))["loads"]


def timeless(record):
    """Without times, which differ from run to run."""
    if isinstance(record, dict):
        return {key: timeless(value) for key, value in record.items() if "seconds" not in key}
    return [timeless(entry) for entry in record] if isinstance(record, list) else record


def test_studies_of_elements_are_data_frames():
    pytest.importorskip("pandas")
    table = sf.compare(sf.Element("tri3"), shapes=3, iterations=20)
    assert len(table) > 3 and len(table.columns) > 3
    cases = sf.stability(sf.Element("tri3"))
    assert len(cases) > 20 and {"family", "verdict"} <= set(cases.columns)
    assert not (cases["verdict"] == "lost").any()


def test_comparisons_are_long_tables(tmp_path):
    pandas = pytest.importorskip("pandas")
    keys = {
        "compare": {
            "elements": ["tri3", "quad4"],
            "shapes": {"count": 4, "seed": [1, 2]},
            "fit": [{"objective": ["frobenius", "spectral"], "nonnegative": True}],
        }
    }
    table = sf.compare(keys)
    values = table[table.quantity == "spectral"]
    assert len(values) == 2 * 2 * 2 * 4 and values.value.between(0, 2).all()
    medians = values.groupby(["element", "fit"]).value.median().unstack()
    assert (medians["spectral k>=0"] <= medians["frobenius k>=0"]).all()
    seconds = table[table.quantity == "seconds fit"]
    assert (seconds.value > 0).all() and (seconds.groupby(["case", "fit"]).size() >= 5).all()
    path = tmp_path / "norms.toml"
    path.write_text(
        '[compare]\nelements = ["tri3", "quad4"]\nshapes = { count = 4, seed = [1, 2] }\n'
        '[[compare.fit]]\nobjective = ["frobenius", "spectral"]\nnonnegative = true\n'
    )
    again = sf.compare(path)
    same = again[again.quantity == "spectral"].value.reset_index(drop=True)
    pandas.testing.assert_series_equal(same, values.value.reset_index(drop=True))
    with pytest.raises(sf.SpringfitError) as error:
        sf.compare({"compare": {"elements": []}})
    assert "elements" in str(error.value)
    with pytest.raises(sf.SpringfitError):
        sf.compare(keys, poisson=0.3)


@pytest.mark.parametrize(
    "call, key",
    [
        (lambda: sf.compare("nowhere.toml"), None),
        (lambda: sf.compare({**SCENE, "fix": [{"group": "left"}]}), "fix[0].group"),
        (lambda: sf.compare(sf.Element("tri3"), iterations=0), "iterations"),
        (lambda: sf.compare(sf.Element("tri3"), poisson=0.7), "poisson"),
        (lambda: sf.compare(sf.Element("tri3"), plane="both"), "plane"),
        (lambda: sf.converge(SCENE, levels=1), "levels"),
        (lambda: sf.converge(SCENE, levels=2, truth={}), None),
        (lambda: sf.stability("nowhere.toml"), None),
    ],
)
def test_wrong_studies_are_named(call, key):
    with pytest.raises(sf.SpringfitError) as error:
        call()
    assert key is None or key in str(error.value.key), str(error.value)

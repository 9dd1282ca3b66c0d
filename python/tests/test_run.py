"""Whole scenes, and sweeps over them."""

import json
import subprocess
import sys

import numpy as np
import pytest

import springfit as sf
from conftest import square

SCENE = square(4)


def test_a_scene_as_a_dictionary_and_as_a_file(tmp_path, scenes):
    report = sf.run(SCENE, out=tmp_path / "out")
    assert [p.name for p in report.files] == ["frobenius.json", "exact.json", "report.json"]
    written = json.loads((tmp_path / "out" / "report.json").read_text())
    # The file alone has the names of the files beside it.
    assert written.pop("files") == [p.name for p in report.files]
    assert written == report.record
    assert report.loads["fit"].tolist() == ["frobenius", "exact"]
    moved = report.displacements["tension"]
    assert np.allclose(moved["exact"], moved[""], rtol=1e-9, atol=1e-12)
    assert not np.allclose(moved["frobenius"], moved[""], rtol=1e-3)
    own = sf.run(scenes / "square_quad.toml")
    again = sf.run(scenes / "square_quad.toml", set={"material.poisson": own.record["poisson"]})
    assert own.loads["e_rms"].tolist() == again.loads["e_rms"].tolist() and len(own.loads) > 10
    other = sf.run(scenes / "square_quad.toml", set={"material.poisson": 0.1, "fit[0].name": "first"})
    assert other.record["poisson"] == 0.1 and other.record["fits"][0]["name"] == "first"


def test_figures_equal_those_of_the_command(tmp_path, scenes, command):
    subprocess.run([command, "run", str(scenes / "square_quad.toml"), "--out", str(tmp_path)], check=True, capture_output=True)
    theirs = json.loads((tmp_path / "report.json").read_text())
    ours = sf.run(scenes / "square_quad.toml").record
    for a, b in zip(theirs["fits"], ours["fits"], strict=True):
        assert [load["e_rms"] for load in a["loads"]] == [load["e_rms"] for load in b["loads"]]
    mesh = scenes / "meshes" / "cube_tet.msh"
    subprocess.run(
        [command, "fit", str(mesh), "--young", "10kPa", "--poisson", "0.3", "-o", str(tmp_path / "net.json")],
        check=True,
        capture_output=True,
    )
    springs = [s for s in json.loads((tmp_path / "net.json").read_text())["springs"] if s["kind"] == "length"]
    net = sf.fit(sf.Mesh.read(mesh), sf.Material(1e4, 0.3))
    assert [s["constant"] for s in springs] == net.constants.tolist()
    assert [s["points"] for s in springs] == net.springs.tolist()


@pytest.mark.parametrize(
    "change, key",
    [
        ({"material": {"young": 1e4}}, "poisson"),
        ({"fit": []}, "fit"),
        ({"fit": [{"objective": "frobenius", "name": 'a"\\'}, {"objective": "x"}]}, "fit[1].objective"),
        ({"fit": [{"objective": "frobenius", "name": 'a"\\\n'}]}, "fit[0].name"),
        ({"fix": [{"group": "left"}]}, "fix[0].group"),
        ({"mesh": {"file": "nowhere.msh"}}, None),
        ({"material": {"young": float("nan"), "poisson": 0.3}}, "material.young"),
    ],
)
def test_wrong_scenes_are_named(change, key):
    with pytest.raises(sf.SpringfitError) as error:
        sf.run({**SCENE, **change})
    assert key is None or key in f"{error.value.key} {error.value}", str(error.value)


def test_wrong_paths_of_keys_are_named():
    for path in ["fit[7].name", "material.young.value", "a b", "fit[x]"]:
        with pytest.raises(sf.SpringfitError):
            sf.run(SCENE, set={path: 1})


def test_ctrl_c_ends_a_long_run():
    code = (
        "import springfit as sf, numpy as np, signal\n"
        # A process that begins in the background ignores interrupts.
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "mesh = sf.Mesh.box('hex20', size=[1, 1, 1], cells=[12, 12, 12])\n"
        "x = mesh.points + 1e-3 * np.random.default_rng(1).uniform(-1, 1, mesh.points.shape)\n"
        "print('go', flush=True)\n"
        "sf.fit(sf.Mesh(x, dict(mesh.cells)), sf.Material(1e4, 0.3), 'spectral', nonnegative=True)\n"
    )
    import signal
    import time

    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "go\n"
    time.sleep(1)
    process.send_signal(signal.SIGINT)
    start = time.monotonic()
    _, errors = process.communicate(timeout=120)
    assert "KeyboardInterrupt" in errors and process.returncode != 0, (errors, time.monotonic() - start)

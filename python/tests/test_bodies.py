"""The benchmark of benches/bodies: its reference, its results, and the script that scores networks on its own."""

import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import springfit as sf

FOLDER = Path(__file__).resolve().parents[2] / "benches" / "bodies"
BODIES = sorted(path.stem for path in FOLDER.glob("*.toml"))
sys.path.insert(0, str(FOLDER))
import score  # noqa: E402

KEYS = ("e_rms", "e_max", "e_tip", "e_energy")


def run(script, *arguments):
    return subprocess.run(
        [sys.executable, str(FOLDER / script), *map(str, arguments)], capture_output=True, text=True, timeout=100
    )


@pytest.mark.parametrize("options", [["--check"], ["--springfit"]])
def test_the_reference_is_that_of_scikit_fem_and_of_springfit(options):
    # 1e-9 of the largest displacement is the limit of the script: two solvers agree to their rounding.
    made = run("reference.py", *options)
    assert made.returncode == 0, made.stdout + made.stderr
    assert len(made.stdout.split("\n")) - 1 == 3 * len(BODIES)


@pytest.mark.parametrize("body", BODIES)
def test_a_score_is_that_of_the_report_and_of_the_results(body, tmp_path):
    scene = tomllib.loads((FOLDER / f"{body}.toml").read_text())
    fits = [fit for fit in scene["fit"] if fit["objective"] not in ("spectral", "whole")]
    report = sf.run({**scene, "fit": fits}, folder=FOLDER, out=tmp_path)
    known = {row["method"]: row for row in json.loads((FOLDER / "results/springfit.json").read_text())["rows"] if row["body"] == body}
    files = [file for file in report.files if file.name != "report.json"]
    assert len(files) == len(fits)
    printed = run("score.py", body, files[0], "--row", fits[0]["objective"], "--json")
    assert printed.returncode == 0, printed.stderr
    reference = score.read(FOLDER / "reference" / f"{body}.json", "springfit benchmark body")
    for file, fit in zip(files, report.record["fits"], strict=True):
        row = score.score(reference, score.read(file, "springfit network"))
        if file == files[0]:
            assert json.loads(printed.stdout) == {"body": body, "method": fit["name"], **row}
        assert row["definite"] == (fit["status"] == "stable"), fit["name"]
        assert row["springs"] == known[fit["name"]]["springs"]
        for load in fit["loads"]:
            for key in KEYS:
                assert row["loads"][load["name"]][key] == pytest.approx(load[key], abs=1e-6)
                # A convex programme is behind some fits: its last digits depend on the machine.
                assert row["loads"][load["name"]][key] == pytest.approx(known[fit["name"]]["loads"][load["name"]][key], abs=1e-3)


def test_points_in_another_order_have_the_same_score(tmp_path):
    path = tmp_path / "net.json"
    scene = tomllib.loads((FOLDER / "cube_tet.toml").read_text())
    sf.fit(sf.Mesh.read(FOLDER / scene["mesh"]["file"], scale=0.01), sf.Material(10e3, 0.3), "exact").write(path)
    network = json.loads(path.read_text())
    last = len(network["points"]) - 1
    network["points"].reverse()
    for spring in network["springs"]:
        spring["points"] = [last - point for point in spring["points"]]
    path.write_text(json.dumps(network))
    made = run("score.py", "cube_tet", path, "--json")
    assert made.returncode == 0, made.stderr
    assert all(abs(load[key]) < 1e-9 for load in json.loads(made.stdout)["loads"].values() for key in KEYS)


def test_networks_that_cannot_be_scored_are_named(tmp_path):
    good = tmp_path / "net.json"
    mesh = sf.Mesh.read(FOLDER / "../../scenes/meshes/cube_tet.msh", scale=0.01)
    sf.fit(mesh, sf.Material(10e3, 0.3), "offdiag").write(good)
    network = json.loads(good.read_text())
    springs = network["springs"]
    wrong = {
        "without stiffness": {"springs": springs[:100]},
        "law": {"springs": [{**springs[0], "law": "k*c"}]},
        "not in balance": {"springs": [{**spring, "rest": 0.9 * spring["rest"]} for spring in springs]},
        "expected every point of the body": {"points": [[2 * c for c in point] for point in network["points"]]},
        "springs[0].points": {"springs": [{**springs[0], "points": [0, 147]}]},
        "'measures'": {"measures": None},
    }
    for word, change in wrong.items():
        changed = {key: value for key, value in {**network, **change}.items() if value is not None}
        (tmp_path / "wrong.json").write_text(json.dumps(changed))
        made = run("score.py", "cube_tet", tmp_path / "wrong.json")
        assert made.returncode == 2 and word in made.stderr and "Traceback" not in made.stderr, made.stderr
    assert run("score.py", "nobody", good).returncode == 2


def test_the_table_of_the_book_is_that_of_the_results():
    page = (FOLDER / "../../docs/src/studies/benchmark.md").read_text()
    table = run("table.py").stdout
    assert table.count("\n") > 10 and table in page
    # The largest difference that the page states, in powers of ten.
    found = [float(line.split()[-1]) for line in run("reference.py", "--springfit").stdout.splitlines()]
    assert max(found) < 1e-11, found
    assert re.search(r"springfit's own finite elements agree", page)


@pytest.mark.long
def test_all_results_are_those_of_the_command(command):
    made = run("results.py", "--springfit", command, "--check")
    assert made.returncode == 0, made.stdout + made.stderr

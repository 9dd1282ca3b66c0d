"""Sweeps: the same rows however they are run, and those of the command."""

import json
import multiprocessing
import subprocess
import sys
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pandas
import pytest

import springfit as sf
from conftest import square

SCENE = square(4)
OVER = {"material.poisson": [0.0, 0.2, 0.4, 1.5], "mesh.box.cells": [[2, 2], [3, 3]]}


def sweep(**options):
    return sf.sweep(SCENE, OVER, **options)


def test_a_sweep_is_the_same_however_it_is_run():
    alone = sweep()
    # Six studies of two fits, and two that fail.
    assert len(alone) == 6 * 2 + 2 and alone["error"].notna().sum() == 2
    assert alone["study"].tolist() == [1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 8]
    assert alone.loc[alone["study"] == 3, "material.poisson"].tolist() == [0.2, 0.2]
    seen = []
    with ThreadPoolExecutor(2) as threads:
        assert sweep(executor=threads, progress=lambda *step: seen.append(step)).equals(alone)
    assert seen == [("studies", done, 8) for done in range(1, 9)]
    with ProcessPoolExecutor(2) as processes:
        assert sweep(executor=processes).equals(alone)
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        assert sweep(executor=pool).equals(alone)


def test_a_sweep_on_dask():
    distributed = pytest.importorskip("distributed")
    with distributed.Client(n_workers=2, threads_per_worker=1, dashboard_address=None) as client:
        assert sweep(executor=client).equals(sweep())


def test_a_sweep_on_ray():
    ray = pytest.importorskip("ray")
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    try:
        assert sweep(executor=ray).equals(sweep())
    finally:
        ray.shutdown()


def test_a_study_is_a_run():
    table = sweep()
    for study, poisson in [(1, 0.0), (5, 0.4)]:
        cells = [2, 2]
        report = sf.run(SCENE, set={"material.poisson": poisson, "mesh.box.cells": cells})
        assert table.loc[table["study"] == study, "e_rms"].tolist() == report.loads["e_rms"].tolist()


def test_a_sweep_goes_on_where_it_was_killed(tmp_path):
    records = tmp_path / "sweep.jsonl"
    whole = sweep(records=records)
    lines = records.read_text().splitlines(keepends=True)
    assert len(lines) == 8
    # Killed in the middle of a line.
    records.write_text("".join(lines[:3]) + lines[3][:20])
    assert sweep(records=records).equals(whole)
    assert len(records.read_text().splitlines()) == 8
    before = records.read_text()
    assert sweep(records=records).equals(whole) and records.read_text() == before
    with pytest.raises(sf.SpringfitError) as error:
        sf.sweep(SCENE, OVER, set={"material.young": 1.0}, records=records)
    assert error.value.file == str(records) and error.value.line == 1
    records.write_text("not a sweep\n")
    with pytest.raises(sf.SpringfitError):
        sweep(records=records)


def test_samples_are_those_of_scipy():
    qmc = pytest.importorskip("scipy.stats.qmc")
    keys = ["material.young", "material.thickness", "material.density", "mesh.scale", *(f"load[0].traction[{i}]" for i in range(2))]
    over = {key: {"from": 0.0, "to": 1.0} for key in keys}
    scene = {**SCENE, "mesh": {"box": {"element": "quad4", "size": [1.0, 1.0], "cells": [1, 1]}}}
    over.pop("mesh.scale")
    table = sf.sweep(scene, over, design="sobol", samples=32)
    ours = table.drop_duplicates("study")[list(over)].to_numpy(float)
    assert np.array_equal(ours, qmc.Sobol(len(over), scramble=False).random(32))
    # Moved by a seed, the points lie as evenly.
    moved = sf.sweep(scene, over, design="sobol", samples=32, seed=5).drop_duplicates("study")[list(over)].to_numpy(float)
    assert not np.array_equal(moved, ours)
    assert all(len(set((column * 32).astype(int))) == 32 for column in moved.T)
    assert qmc.discrepancy(moved) < 2 * qmc.discrepancy(ours)


def test_rows_are_those_of_the_command(tmp_path, command):
    scene = tmp_path / "scene.toml"
    scene.write_text(
        '[mesh]\nbox = { element = "quad4", size = [1, 1], cells = [3, 3] }\n[material]\nyoung = "10 kPa"\npoisson = 0.3\n'
        '[[fit]]\nobjective = "frobenius"\n[[fix]]\ngroup = "ymin"\n[[load]]\ngroup = "ymax"\ntraction = [0, 100]\n'
        '[sweep]\ndesign = "sobol"\nsamples = 9\nseed = 3\n'
        '[sweep.over]\nmaterial.poisson = { from = 0, to = 1.2 }\nmaterial.young = { from = "1 kPa", to = "9 kPa", spacing = "log" }\n'
    )
    arguments = ["sweep", str(scene), "--jobs", "2", "--json", "--out", str(tmp_path / "out")]
    run = subprocess.run([command, *arguments], check=True, capture_output=True)
    ours = sf.sweep(scene)
    assert (tmp_path / "out" / "table.csv").read_text().splitlines()[0] == ",".join(ours)
    theirs = pandas.DataFrame(json.loads(run.stdout), columns=list(ours))
    assert ours["error"].notna().any() and ours["e_rms"].notna().any()
    for column in ours:
        a, b = ours[column], theirs[column]
        assert (a.isna() == b.isna()).all() and (a.dropna() == b.dropna()).all(), column
    # Either goes on from the other's lines.
    records = tmp_path / "out" / "studies.jsonl"
    before = records.read_text()
    assert sf.sweep(scene, records=records).equals(ours) and records.read_text() == before
    assert len(sf.sweep(scene, samples=3)) == 3


class Closed:
    def submit(self, *arguments):
        raise RuntimeError("cannot schedule new futures after shutdown")


class Broken:
    def submit(self, *arguments):
        future = Future()
        future.set_exception(OSError("the process has ended"))
        return future


@pytest.mark.parametrize("executor", [Closed(), Broken(), object(), 3])
def test_executors_that_do_not_work_are_named(executor):
    with pytest.raises(sf.SpringfitError) as error:
        sweep(executor=executor)
    assert error.value.key == "executor", str(error.value)


@pytest.mark.parametrize(
    "over, options, key",
    [
        ({}, {}, "sweep.over"),
        ([], {}, "sweep.over"),
        ([1], {}, "sweep.over[0]"),
        (3, {}, None),
        ({"material.poisson": []}, {}, "sweep.over.material.poisson"),
        ({"material.poisson": np.nan}, {}, "sweep.over.material.poisson"),
        ({"material.poisson": [object()]}, {}, "over.material.poisson"),
        ({"material.poison": [0.1]}, {}, "material.poison"),
        ({"fit[9].tied": [True]}, {}, "fit"),
        ({"material.poisson": [0.1]}, {"samples": 3}, "sweep.samples"),
        ({"material.poisson": [0.1]}, {"design": "latin"}, "sweep.design"),
        (None, {}, "sweep"),
    ],
)
def test_wrong_sweeps_are_named(over, options, key):
    with pytest.raises((sf.SpringfitError, TypeError)) as error:
        sf.sweep(SCENE, over, **options)
    assert key is None or key in str(error.value), str(error.value)


def test_values_may_be_arrays_and_iterators():
    table = sf.sweep(SCENE, {"material.poisson": np.linspace(0.1, 0.3, 3), "fit[0].tied": iter([True, False])})
    assert table["study"].max() == 6
    listed = sf.sweep(SCENE, ({"material.poisson": p} for p in (0.1, 0.2)))
    assert listed.drop_duplicates("study")["material.poisson"].tolist() == [0.1, 0.2]


def test_a_killed_sweep_leaves_whole_lines(tmp_path):
    records = tmp_path / "r.jsonl"
    code = (
        "import springfit as sf, json, sys\n"
        f"scene = json.loads({json.dumps(json.dumps(SCENE))})\n"
        f"sf.sweep(scene, {{'material.poisson': [i / 1000 for i in range(500)]}}, records={str(records)!r}, progress=lambda *s: print(s[1], flush=True))\n"
    )
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    for line in process.stdout:
        if int(line) >= 5:
            process.kill()
            break
    process.wait(timeout=60)
    lines = records.read_text().splitlines()
    assert len(lines) >= 5 and all("report" in json.loads(line) for line in lines[:5])
    table = sf.sweep(SCENE, {"material.poisson": [i / 1000 for i in range(8)]}, records=records)
    assert table["study"].nunique() == 8

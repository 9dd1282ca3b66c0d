"""Scenes whose meshes and materials are in memory are those of files, and give them back."""

import json
import pickle
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest

import springfit as sf

pytest.importorskip("pandas")

FITS = [{"objective": "frobenius"}, {"objective": "exact"}]
LOADS = {"fix": [{"group": "xmin"}], "load": [{"name": "pull", "group": "xmax", "traction": [100, 0, 0]}], "fit": FITS}
BOX = {"box": {"element": "tet4", "size": [2, 1, 1], "cells": [4, 2, 2]}}
MATERIAL = {"young": 1e4, "poisson": 0.3, "density": 1000.0}


def mesh(cells=(4, 2, 2)):
    return sf.Mesh.box("tet4", size=[2, 1, 1], cells=cells)


def scene(**keys):
    return {"mesh": mesh(), "material": sf.Material(**MATERIAL), **LOADS, **keys}


def test_a_mesh_in_memory_is_that_of_the_scene(tmp_path):
    own, known = sf.run(scene(output={"json": True}), out=tmp_path), sf.run({"mesh": BOX, "material": MATERIAL, **LOADS})
    for fit in ("frobenius", "exact"):
        assert np.array_equal(own.displacements["pull"][fit], known.displacements["pull"][fit])
    networks = [path for path in own.files if path.suffix == ".json" and path.name != "report.json"]
    assert len(networks) == 2 and all("mesh from memory (" in path.read_text() for path in networks)


def test_reports_give_mesh_and_networks_back():
    report = sf.run(scene())
    assert np.array_equal(report.points, mesh().points) and list(report.networks) == ["frobenius", "exact"]
    for name, net in report.networks.items():
        known = sf.fit(mesh(), sf.Material(**MATERIAL), name)
        assert np.array_equal(net.constants, known.constants) and np.array_equal(net.masses, known.masses)
    forces = np.zeros_like(report.points)
    u = report.networks["exact"].solve(fix="xmin", forces=forces)
    assert np.abs(u).max() == 0
    comparison = sf.compare(scene(mesh=mesh([1, 1, 1])))
    with pytest.raises(sf.SpringfitError) as error:
        comparison.mesh
    assert error.value.key == "mesh"
    assert "<table>" in report._repr_html_() and "<table>" in mesh()._repr_html_()


def test_arrays_by_cell_and_regions_are_in_scenes():
    body = mesh()
    young = np.where(body.centers[:, 0] > 1, 5e4, 1e4)
    body = sf.Mesh(body.points, body.cells, body.groups, cell_groups={"far": body.centers[:, 0] > 1})
    by_cell = sf.run(scene(mesh=body, material=sf.Material(young, 0.3)))
    by_region = sf.run(scene(mesh=body, material={"far": sf.Material(5e4, 0.3), None: sf.Material("10 kPa", 0.3)}))
    by_text = sf.run({"mesh": BOX, "material": [{"young": 5e4, "poisson": 0.3, "where": "x > 1"}, {"young": 1e4, "poisson": 0.3}], **LOADS})
    for other in (by_region, by_text):
        assert np.allclose(by_cell.displacements["pull"][""], other.displacements["pull"][""], rtol=1e-9)


def test_refined_cells_have_the_values_of_the_cells_that_they_were():
    body = mesh()
    young = np.where(body.centers[:, 0] > 1, 5e4, 1e4)
    by_cell = sf.converge(scene(material=sf.Material(young, 0.3)), levels=2)
    by_text = [{"young": 5e4, "poisson": 0.3, "where": "x > 1"}, {"young": 1e4, "poisson": 0.3}]
    known = sf.converge(scene(material=by_text), levels=2)
    strip = lambda found: json.loads(json.dumps(found), parse_float=lambda text: round(float(text), 9))
    own, other = strip(by_cell), strip(known)
    assert [level["cells"] for level in own["levels"]] == [96, 768]
    assert own["loads"][0]["truth"]["value"] == pytest.approx(other["loads"][0]["truth"]["value"], rel=1e-9)
    for model, known in zip(own["loads"][0]["models"], other["loads"][0]["models"]):
        values = [step["compliance"] for step in model["steps"]]
        assert values == pytest.approx([step["compliance"] for step in known["steps"]], rel=1e-9)


def test_all_studies_take_meshes():
    assert len(sf.compare(scene(mesh=mesh([1, 1, 1]))).fits) > 2
    assert len(sf.stability(scene())) > 2
    reference = sf.run(scene(reference={"mesh": mesh().refine()}))
    assert reference.loads["e_rms"].notna().all()


def test_sweeps_take_meshes_also_in_processes(tmp_path):
    over = {"material.poisson": [0.1, 0.4]}
    own = scene(material=sf.Material(np.full(len(mesh().centers), 1e4), 0.3))
    records = tmp_path / "studies.jsonl"
    table = sf.sweep(own, over, records=records)
    assert table["error"].isna().all() and len(table) == 4
    with ProcessPoolExecutor(2) as processes:
        again = sf.sweep(own, over, executor=processes)
    assert np.array_equal(again["e_rms"], table["e_rms"])
    # The same again comes from the records; another mesh is refused.
    before = records.read_text()
    sf.sweep(own, over, records=records)
    assert records.read_text() == before
    other = sf.Mesh.box("tet4", size=[2, 1, 1], cells=[2, 2, 2])
    with pytest.raises(sf.SpringfitError, match="a study of"):
        sf.sweep({**own, "mesh": other, "material": MATERIAL}, over, records=records)
    meshes = sf.sweep({**own, "material": MATERIAL}, {"mesh": [mesh(), other]})
    assert sorted(set(meshes["elements"])) == [48, 96]


@pytest.mark.parametrize(
    "change, key",
    [
        ({"set": {"mesh.scale": 2.0}}, "mesh.scale"),
        ({"set": {"materials": 2.0}}, "materials"),
        ({"set": {"material.poisson": 0.7}}, "material.poisson"),
    ],
)
def test_faults_of_dictionaries_name_no_file(change, key):
    with pytest.raises(sf.SpringfitError) as error:
        sf.run(scene(), **change)
    assert error.value.file is None and error.value.line is None and error.value.key == key


def test_unknown_keys_of_dictionaries_name_no_line():
    with pytest.raises(sf.SpringfitError) as error:
        sf.run(scene(materials=3))
    assert (error.value.file, error.value.line) == (None, None) and 'did you mean "material"' in str(error.value)
    assert "scene.toml" not in str(error.value)


def test_reports_are_pickled():
    report = sf.run(scene())
    try:
        again = pickle.loads(pickle.dumps(report))
    except TypeError as error:
        pytest.skip(f"networks are not pickled: {error}")
    assert np.array_equal(again.networks["exact"].constants, report.networks["exact"].constants)


def test_tables_have_no_empty_columns():
    report = sf.run(scene())
    for table in (report.fits, report.loads):
        assert len(table) and not table.isna().all().any()

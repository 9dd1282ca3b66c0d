"""What is given to the module: values of keys, numbers, texts; and what it does with copies and interrupts."""

import copy
import json
import os
import pickle
import signal
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import springfit as sf
from conftest import square

MATERIAL = sf.Material(young=1e4, poisson=0.3, density=1000.0)
MESH = sf.Mesh.box("quad4", size=[1, 1], cells=[2, 2])
SCENE = square(2)
ROOT = Path(__file__).resolve().parents[2]


def key_of(call):
    with pytest.raises(sf.SpringfitError) as error:
        call()
    return error.value.key


class Endless:
    def tolist(self):
        return self


def inside_itself(kind):
    value = kind()
    value.append(value) if kind is list else value.update(a=value)
    return value


def nested(depth):
    value = 0.5
    for _ in range(depth):
        value = [value]
    return value


@pytest.mark.parametrize("kind", [np.float16, np.float32, np.float64, np.longdouble])
def test_numbers_of_numpy_are_numbers(kind):
    known = sf.fit(MESH, MATERIAL, "modal", higher=0.5)
    for value in (kind(0.5), np.array(0.5, kind)):
        assert np.array_equal(sf.fit(MESH, MATERIAL, "modal", higher=value).constants, known.constants)
    box = {"element": "quad4", "size": np.ones(2, kind), "cells": np.array([2, 2])}
    assert sf.run({**SCENE, "mesh": {"box": box}}).loads["e_rms"].tolist() == sf.run(SCENE).loads["e_rms"].tolist()


@pytest.mark.parametrize(
    "value",
    [
        np.clongdouble(0.5),
        np.ones(2, np.clongdouble),
        0.5j,
        Endless(),
        inside_itself(list),
        inside_itself(dict),
        nested(20000),
        np.timedelta64(5, "ns"),
        np.datetime64(5, "ns"),
        np.ma.array([0.5, 0.5], mask=[False, True]),
        np.ma.masked,
        "\ud800",
        {1: 2},
    ],
    ids=lambda value: type(value).__name__,
)
def test_values_that_are_none_of_toml_are_named(value):
    assert key_of(lambda: sf.fit(MESH, MATERIAL, "modal", higher=value)).startswith("higher")
    assert key_of(lambda: sf.run({**SCENE, "title": value})).startswith("title")


@pytest.mark.parametrize(
    "call, key",
    [
        (lambda: sf.fit(MESH, MATERIAL, "frobenius", springs=3), "springs"),
        (lambda: sf.fit(MESH, MATERIAL, "frobenius", springs=[1]), "springs"),
        (lambda: sf.fit(MESH, MATERIAL, "frobenius", name=1), "name"),
        (lambda: sf.fit(MESH, MATERIAL, 3), "objective"),
        (lambda: sf.fit(MESH, MATERIAL, None), "objective"),
        (lambda: sf.Material("10 apples", 0.3), "young"),
        (lambda: sf.Material(True, 0.3), "young"),
        (lambda: sf.Material(1e4, 0.7), "poisson"),
        (lambda: sf.Material(-1e4, 0.3), "young"),
        (lambda: sf.fit(MESH, sf.Material(1e4, 0.3, density="heavy")), "density"),
        (lambda: sf.fit(MESH, sf.Material(1e4, 0.3, plane=1)), "plane"),
        (lambda: sf.fit(MESH, "rubber"), "material"),
        (lambda: sf.run({1: 2}), "scene"),
        (lambda: sf.run({"mesh": {1: 2}}), "mesh"),
        (lambda: sf.run(SCENE, set={1: 2}), "set"),
        (lambda: sf.run(SCENE, set={"material.poisson": None}), "material.poisson"),
        (lambda: sf._core.Mesh.of_box(sf.Element("quad4"), [1, 1], [-2, 2], [0, 0]), "cells[0]"),
        (lambda: sf._core.Mesh.of_box(sf.Element("quad4"), [1, 1], [2, 2.5], [0, 0]), "cells[1]"),
        (lambda: sf._core.Mesh.of_box(sf.Element("quad4"), [1, "1"], [2, 2], [0, 0]), "size[1]"),
        (lambda: sf.Element("\ud800"), "element"),
        (lambda: sf.compare(sf.Element("tri3"), shapes=-1), "shapes"),
        (lambda: sf.converge(SCENE, levels=-1), "levels"),
    ],
)
def test_wrong_arguments_are_named(call, key):
    pytest.importorskip("pandas")
    assert key_of(call) == key


@pytest.mark.parametrize("wrong", ["1e4", True, 1j, np.complex128(1), np.array([1.0, 2.0]), None], ids=repr)
def test_moduli_are_real_numbers(wrong):
    constants = sf.SpringConstants(MESH.cells)
    for place, key in enumerate(["young", "poisson", "thickness"]):
        moduli = [1e4, 0.3, 1.0]
        moduli[place] = wrong
        assert key_of(lambda: constants(MESH.points, *moduli)) == key


@pytest.mark.parametrize(
    "gravity, key",
    [
        ([0, 0, np.nan], "gravity[2]"),
        ([0, np.inf, 0], "gravity[1]"),
        ([0, 0, 1j], "gravity[2]"),
        (np.zeros((3, 1)), "gravity[0]"),
        (np.ma.array([0, 0, 1], mask=[0, 0, 1]), "gravity"),
        ("down", "gravity"),
        ([0, 1], "gravity"),
    ],
)
def test_gravity_is_a_vector(tmp_path, gravity, key):
    net = sf.fit(sf.Mesh.box("tet4", size=[1, 1, 1], cells=[1, 1, 1]), MATERIAL, "offdiag")
    assert key_of(lambda: net._core.export("npz", str(tmp_path / "out"), gravity)) == key
    assert not (tmp_path / "out").exists()


def test_every_error_has_all_attributes():
    error = sf.SpringfitError("x")
    assert (error.kind, error.file, error.line, error.key) == ("invalid", None, None, None)


def test_elements_of_equal_texts_are_equal(tmp_path):
    text = (ROOT / "elements" / "tri3.toml").read_text()
    (tmp_path / "own.toml").write_text(text + "\n")
    own = sf.Element(str(tmp_path / "own.toml"))
    assert sf.Element("tri3") == sf.Element("tri3") == sf.Element.parse(text)
    assert hash(sf.Element("tri3")) == hash(sf.Element.parse(text))
    assert own != sf.Element("tri3") != sf.Element("quad4") and sf.Element("tri3") != "tri3"
    for element in (own, sf.Element("quad9")):
        for other in (copy.copy(element), copy.deepcopy(element), pickle.loads(pickle.dumps(element))):
            assert other == element and other.name == element.name


def test_meshes_are_copied_and_pickled(scenes):
    turned = sf.Mesh([[0, 0], [9, 9], [1, 0], [0, 1], [1, 1]], {"tri3": [[0, 3, 2], [2, 4, 3]]}, {"left": [0, 3]})
    for mesh in (turned, MESH, sf.Mesh.read(scenes / "meshes" / "cube_tet.msh")):
        for other in (copy.deepcopy(mesh), pickle.loads(pickle.dumps(mesh))):
            assert other._core.checksum == mesh._core.checksum and other._core.quality == mesh._core.quality
            assert np.array_equal(other.points, mesh.points)
            assert np.array_equal(other._core.numbers, mesh._core.numbers)
            assert list(other.groups) == list(mesh.groups)
            assert all(np.array_equal(other.groups[name], mesh.groups[name]) for name in mesh.groups)
            assert np.array_equal(sf.fit(other, MATERIAL).constants, sf.fit(mesh, MATERIAL).constants)


def test_constants_and_networks_are_copied():
    constants = sf.SpringConstants(MESH.cells, "modal", higher=0.3, plane="strain")
    known = constants(MESH.points, 1e4, 0.3)[0]
    for other in (copy.deepcopy(constants), pickle.loads(pickle.dumps(constants))):
        assert np.array_equal(other(MESH.points, 1e4, 0.3)[0], known)
    net = sf.fit(MESH, MATERIAL)
    assert np.array_equal(copy.deepcopy(net).constants, net.constants)


@pytest.fixture
def interrupt():
    """Sends Ctrl-C after some seconds."""
    earlier = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield lambda seconds: threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT)).start()
    signal.signal(signal.SIGINT, earlier)


def rough(name, cells):
    mesh = sf.Mesh.box(name, size=[1.0] * len(cells), cells=cells)
    x = mesh.points + 1e-3 * np.random.default_rng(1).uniform(-1, 1, mesh.points.shape)
    return sf.Mesh(x, dict(mesh.cells), mesh.groups)


def test_ctrl_c_ends_work_that_reports_nothing(interrupt):
    mesh, smaller = rough("hex8", [30, 30, 30]), rough("hex8", [20, 20, 20])
    net, forces = sf.fit(smaller, MATERIAL), np.ones(smaller.points.shape)
    for call in [
        lambda: sf.Mesh.box("tet4", size=[1, 1, 1], cells=[50, 50, 50]),
        lambda: sf.fit(mesh, MATERIAL),
        lambda: net.solve(fix="xmin", forces=forces),
    ]:
        start = time.perf_counter()
        call()
        whole = time.perf_counter() - start
        start = time.perf_counter()
        interrupt(0.05)
        with pytest.raises(KeyboardInterrupt):
            call()
            # What is quicker than the signal does not count.
            time.sleep(0.1)
        assert time.perf_counter() - start < max(0.3, whole / 2), whole


def test_progress_is_told_on_the_thread_of_the_call():
    threads = set()
    sf.fit(rough("hex8", [8, 8, 8]), MATERIAL, "offdiag", progress=lambda *_: threads.add(threading.get_ident()))
    assert threads == {threading.get_ident()}

    class Full(Exception):
        pass

    def fails(*_):
        raise Full

    with pytest.raises(Full):
        sf.fit(rough("hex8", [8, 8, 8]), MATERIAL, "offdiag", progress=fails)


def test_files_have_the_density(tmp_path):
    sf.fit(MESH, MATERIAL).write(tmp_path / "net.json")
    assert json.loads((tmp_path / "net.json").read_text())["provenance"]["material"]["density"] == 1000.0


def test_elements_are_named_by_paths():
    path = ROOT / "elements/tri3.toml"
    assert sf.Element(path) == sf.Element("tri3") == sf.Element(str(path))


@pytest.mark.parametrize("kind", [int, np.uint8, list])
def test_numbers_in_place_of_flags_are_refused(kind):
    """Numbers 0 and 1 of all points would be the first two points, again and again."""
    flags = MESH.points[:, 0] < 1e-9
    numbers = flags.astype(int).tolist() if kind is list else flags.astype(kind)
    net = sf.fit(MESH, MATERIAL, "exact")
    calls = {
        "fix": lambda: net.solve(numbers, {"xmax": [0, 1.0]}),
        "groups.low": lambda: sf.Mesh(MESH.points, MESH.cells, {"low": numbers}),
        "cell_groups.low": lambda: sf.Mesh(MESH.points, MESH.cells, cell_groups={"low": np.array([1, 0, 1, 0])}),
    }
    assert {key: key_of(call) for key, call in calls.items()} == {key: key for key in calls}
    bool_answer = net.solve(flags, {"xmax": [0, 1.0]})
    assert np.array_equal(bool_answer, net.solve(np.flatnonzero(flags), {"xmax": [0, 1.0]}))


def test_two_displacements_of_one_point_are_refused():
    net = sf.fit(MESH, MATERIAL, "exact")
    held = MESH.points[:, 0] > -1
    wrong = {"xmax": [1e-3, 0], "ymax": [0, 1e-3]}
    assert key_of(lambda: net.solve(held, displacement=wrong)) == "displacement.ymax"
    net.solve(held, displacement={"xmax": [1e-3, 0], "ymax": [1e-3, 0]})


def test_masses_are_not_negative():
    points, springs = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [[0, 1], [1, 2], [2, 0]]
    assert key_of(lambda: sf.measure(points, springs, [1.0, 1.0, 1.0], masses=[1.0, 1.0, -1.0])) == "masses"

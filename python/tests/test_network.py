"""Networks: their arrays are the energy, its slope and its curvature."""

import json
import pickle

import numpy as np
import pytest

import springfit as sf
from conftest import raised

MATERIAL = sf.Material(young=1e4, poisson=0.3, density=1000.0)


def networks():
    for name, keys in [
        ("tet4", {}),
        ("hex8", {}),
        ("tri3", {}),
        ("quad4", {"objective": "divergence"}),
        ("tet4", {"objective": "frobenius"}),
        ("hex8", {"objective": "offdiag", "nonnegative": True}),
        ("tet4", {"volume": "patches"}),
    ]:
        d = sf.Element(name).dimension
        mesh = sf.Mesh.box(name, size=[1.0, 0.8, 0.7][:d], cells=[3, 2, 2][:d])
        yield f"{name} {keys}", sf.fit(mesh, MATERIAL, **keys)


@pytest.mark.parametrize("title, net", list(networks()))
def test_forces_and_stiffness_are_derivatives(title, net):
    rng = np.random.default_rng(2)
    x = net.points + 0.02 * rng.uniform(-1, 1, net.points.shape)
    step = 1e-6
    for _ in range(3):
        v = rng.uniform(-1, 1, x.shape)
        slope = (net.energy(x + step * v) - net.energy(x - step * v)) / (2 * step)
        assert slope == pytest.approx(-np.sum(net.forces(x) * v), rel=1e-6, abs=1e-6 * abs(net.forces(x)).max())
        bent = -(net.forces(x + step * v) - net.forces(x - step * v)) / (2 * step)
        assert np.allclose(net.stiffness(x) @ v.ravel(), bent.ravel(), rtol=1e-5, atol=1e-5 * abs(bent).max())


@pytest.mark.parametrize("title, net", list(networks()))
def test_arrays_hold_the_energy(title, net):
    """The energy from the arrays alone, as a program that reads them would reckon it."""
    rng = np.random.default_rng(3)
    x = net.points + 0.05 * rng.uniform(-1, 1, net.points.shape)
    length = np.linalg.norm(x[net.springs[:, 1]] - x[net.springs[:, 0]], axis=1)
    energy = np.sum(net.constants * (length - net.rest) ** 2 / 2)
    for kind in net.contents:
        corners = x[kind["points"]]
        if "gradients" in kind:
            g = kind["gradients"].reshape(*kind["points"].shape, -1)
            c = kind["weights"] * np.linalg.det(np.einsum("sak,sal->skl", corners, g))
        elif "cells" in kind:
            content = lambda nodes, row: abs(np.linalg.det(x[row[nodes[1:]]] - x[row[nodes[0]]])) / [1, 1, 2, 6][len(nodes) - 1]
            c = np.array([sum(s * content(list(n), row) for n, s in cells) for cells, row in zip(kind["cells"], kind["points"])])
        else:
            edges = corners[:, 1:] - corners[:, :1]
            c = np.linalg.det(edges) / [1, 1, 2, 6][edges.shape[1]] if kind["kind"] != "angle" else None
            if kind["kind"] in ("area", "volume") and kind["points"].shape[1] != edges.shape[2] + 1:
                pytest.skip("the content of a cell that is no simplex needs its quadrature")
        # Linear springs on content; those of exact networks have a force at rest that balances the others.
        if "law" in kind:
            pytest.skip(f"a law of force: {kind['law']}")
        energy += np.sum(kind["constants"] * (c - kind["rest"]) ** 2 / 2)
    assert energy == pytest.approx(net.energy(x), rel=1e-12)


def test_an_exact_network_is_the_finite_element():
    rng = np.random.default_rng(4)
    mesh = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[4, 4, 4])
    x = mesh.points + 0.03 * rng.uniform(-1, 1, mesh.points.shape)
    mesh = sf.Mesh(x, dict(mesh.cells), mesh.groups)
    net, R = sf.fit(mesh, MATERIAL), sf.stiffness(mesh, MATERIAL)
    assert abs(net.stiffness() - R).max() <= 1e-13 * abs(R).max()
    assert np.abs(net.forces()).max() <= 1e-12 * abs(R).max()
    f = np.zeros_like(net.points)
    f[mesh.groups["zmax"], 2] = 1.0
    u = net.solve(fix="zmin", forces=f)
    from scipy.sparse.linalg import spsolve

    free = np.ones(f.shape, bool)
    free[mesh.groups["zmin"]] = False
    free = free.ravel()
    known = spsolve(R.tocsc()[free][:, free], f.ravel()[free])
    assert np.allclose(u.ravel()[free], known, rtol=1e-9, atol=1e-12 * abs(known).max())
    edges = x[mesh.cells[0][1]]
    volume = np.sum(np.linalg.det(edges[:, 1:] - edges[:, :1])) / 6
    assert net.masses.sum() == pytest.approx(1000.0 * volume)


def test_files_and_records(tmp_path):
    import json

    net = sf.fit(sf.Mesh.box("tet4", size=[1, 1, 1], cells=[2, 2, 2]), MATERIAL, "offdiag")
    net.write(tmp_path / "net.json")
    record = json.loads((tmp_path / "net.json").read_text())
    assert [s["constant"] for s in record["springs"]] == net.constants.tolist()
    assert [s["points"] for s in record["springs"]] == net.springs.tolist()
    assert "offdiag" in net._repr_html_() and "springs" in repr(net)
    with pytest.raises(sf.SpringfitError) as error:
        net.write(tmp_path / "net.xyz")
    assert error.value.kind == "unsupported" and not (tmp_path / "net.xyz").exists()


@pytest.mark.parametrize(
    "keys, key",
    [
        ({"objective": "exakt"}, "objective"),
        ({"objective": "frobenius", "higher": 0.5}, "higher"),
        ({"objective": "exact", "volume": "everywhere"}, "volume"),
        ({"objective": "exact", "volumes": "points"}, "volumes"),
        ({"objective": "offdiag", "springs": ["edge", "diagonal"]}, "springs"),
        ({"objective": "offdiag", "tied": object()}, "tied"),
        ({"objective": "offdiag", "tied": 2**70}, "tied"),
        ({"objective": "whole"}, None),
        ({"objective": "sampled"}, None),
    ],
)
def test_wrong_keys_are_named(keys, key):
    mesh = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[1, 1, 1])
    with pytest.raises(sf.SpringfitError) as error:
        sf.fit(mesh, MATERIAL, **keys)
    assert key is None or key in str(error.value.key), str(error.value)


@pytest.mark.parametrize(
    "keys", [{"young": -1}, {"poisson": 1.1}, {"poisson": float("nan")}, {"plane": "both"}]
)
def test_wrong_materials_are_refused(keys):
    with pytest.raises(sf.SpringfitError):
        sf.fit(sf.Mesh.box("quad4", size=[1, 1], cells=[1, 1]), sf.Material(**{"young": 1e4, "poisson": 0.3, **keys}))


def test_wrong_positions_and_supports_are_refused():
    net = sf.fit(sf.Mesh.box("tet4", size=[1, 1, 1], cells=[1, 1, 1]), MATERIAL)
    for call, key in [
        (lambda: net.energy(np.zeros((3, 3))), "x"),
        (lambda: net.forces(np.full(net.points.shape, np.inf)), "x[0]"),
        (lambda: net.solve(fix="left"), "fix"),
        (lambda: net.solve(fix=[99]), "fix"),
        (lambda: net.solve(fix=[0]), "fix"),
        (lambda: net.solve(fix="zmin", forces=np.zeros(3)), "forces"),
    ]:
        raised(call, key)


def test_mechanisms_are_refused():
    mesh = sf.Mesh.box("quad4", size=[1, 1], cells=[3, 3])
    net = sf.fit(mesh, MATERIAL, "frobenius", springs=["edge"])
    sheared = np.zeros_like(mesh.points)
    sheared[mesh.groups["xmax"], 1] = 1.0
    with pytest.raises(sf.SpringfitError) as error:
        net.solve(fix="xmin", forces=sheared)
    assert error.value.key == "fix"


def test_notes_are_those_of_the_command():
    points = [[0, 0], [1, 0], [0, 1], [5, 5], [6, 5], [5, 6], [9, 9]]
    mesh = sf.Mesh(points, {"tri3": [[0, 2, 1], [3, 4, 5]]})
    for material, thick in [(MATERIAL, 0), (sf.Material(1e4, 0.3, thickness=0.1), 1)]:
        notes = " ".join(sf.fit(mesh, material).notes)
        assert ("assumed to be 1 m" in notes) == (thick == 0)
        assert "2 pieces" in notes and "reversed" in notes and "1 points of the file" in notes
    solid = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[1, 1, 1])
    assert not any("assumed" in note or "pieces" in note for note in sf.fit(solid, MATERIAL).notes)


@pytest.mark.parametrize("name, points, cells", [("tet4", np.eye(4, 3), [[3, 0, 1, 2]]), ("bar2", [[0], [1], [3]], [[0, 1], [1, 2]])])
def test_only_plane_bodies_have_a_slope_by_thickness(name, points, cells):
    constants = sf.SpringConstants({name: cells})
    for thickness in (0.0, 1.0):
        assert constants.gradient(points, 1e4, 0.3, thickness, weights=np.ones(len(constants.springs))).thickness == 0.0


def test_progress_is_told_and_may_end_the_work():
    mesh = sf.Mesh.box("hex8", size=[1, 1, 1], cells=[30, 30, 30])
    x = mesh.points + 0.005 * np.random.default_rng(5).uniform(-1, 1, mesh.points.shape)
    mesh = sf.Mesh(x, dict(mesh.cells))
    seen = []
    sf.fit(mesh, MATERIAL, "offdiag", progress=lambda *step: seen.append(step))
    assert seen and all(0 <= done <= total for _, done, total in seen)

    def stop(*step):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sf.fit(mesh, MATERIAL, "offdiag", progress=stop)
    # The module works as before.
    assert len(sf.fit(mesh, MATERIAL, "offdiag")) > 0


def test_the_lock_is_released():
    import threading
    import time

    mesh = sf.Mesh.box("hex8", size=[1, 1, 1], cells=[12, 12, 12])
    x = mesh.points + 0.01 * np.random.default_rng(6).uniform(-1, 1, mesh.points.shape)
    mesh, ticks, done = sf.Mesh(x, dict(mesh.cells)), [], threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    sf.fit(mesh, MATERIAL, "spectral")
    done.set()
    thread.join()
    assert len(ticks) > 10


def test_a_word_stands_for_groups_as_in_scenes():
    mesh = sf.Mesh.box("tet4", [1, 1, 1], [2, 2, 2])
    word = sf.fit(mesh, sf.Material(1e4, 0.3), "frobenius", springs="all + volume")
    listed = sf.fit(mesh, sf.Material(1e4, 0.3), "frobenius", springs=["all + volume"])
    assert np.array_equal(word.constants, listed.constants) and len(word.constants) > 0
    with pytest.raises(sf.SpringfitError, match="springs"):
        sf.fit(mesh, sf.Material(1e4, 0.3), "frobenius", springs=3)


def ways(net, folder):
    """The same network, by each way out of and into Python."""
    net.save(folder / "n.json")
    yield "json", sf.Network.load(folder / "n.json")
    yield "pickle", pickle.loads(pickle.dumps(net))
    yield "constants", net.with_constants(net.constants)
    if all(group["kind"] in ("area", "volume", "bulk") for group in net.contents):
        net.save(folder / "n.npz")
        yield "npz", sf.Network.load(folder / "n.npz")


def test_plane_networks_keep_their_thickness(tmp_path):
    mesh = sf.Mesh.box("tri3", size=[0.04, 0.02], cells=[4, 2])
    net = sf.fit(mesh, sf.Material(2e4, 0.3, plane="strain", thickness=0.003, density=1100))
    for way, other in ways(net, tmp_path):
        found = sf.measure(other)
        assert found.affine.young == pytest.approx(2e4, rel=1e-9), way
        assert found.affine.poisson == pytest.approx(0.3, rel=1e-9), way
        assert found.density == pytest.approx(1100, rel=1e-9), way
        other.save(tmp_path / "again.json")
        assert sf.measure(tmp_path / "again.json").affine.young == pytest.approx(2e4, rel=1e-9), way


def test_networks_of_engines_stay_those_of_their_engine(tmp_path):
    mesh = sf.Mesh.box("tet4", size=[0.04, 0.02, 0.02], cells=[4, 2, 2])
    fit = {"name": "e", "objective": "offdiag", "nonnegative": True, "engine": {"method": "xpbd", "substeps": 10}}
    scene = {"mesh": mesh, "material": {"young": 2e4, "poisson": 0.3, "density": 1100}, "fit": [fit], "fix": [{"group": "xmin"}]}
    net = sf.run(scene | {"load": [{"name": "a", "group": "xmax", "traction": [0, 0, 1]}]}).networks["e"]
    for way, other in ways(net, tmp_path):
        with pytest.raises(sf.SpringfitError, match="engine"):
            other.export("lammps", tmp_path / way, gravity=[0, 0, 0])


def test_networks_of_runs_keep_damping_supports_and_fitted_masses(tmp_path):
    mesh = sf.Mesh.box("tet4", size=[0.04, 0.02, 0.02], cells=[4, 2, 2])
    scene = {
        "mesh": mesh,
        "material": {"young": 2e4, "poisson": 0.3, "density": 1100},
        "fit": [{"name": "e", "objective": "offdiag", "nonnegative": True}],
        "fix": [{"group": "xmin"}],
        "load": [{"name": "a", "group": "xmax", "traction": [0, 0, 1]}],
        "motion": {"duration": 1e-3, "step": 1e-5, "damping": {"rayleigh": [0.5, 0.0]}},
    }
    report = sf.run(scene, out=tmp_path / "out")
    written = json.loads((tmp_path / "out" / "e.json").read_text())
    assert written["damping"]["mass"] == 0.5 and written["held"]
    for way, other in ways(report.networks["e"], tmp_path):
        other.save(tmp_path / "again.json")
        again = json.loads((tmp_path / "again.json").read_text())
        keys = ("damping", "motion", "held", "loads", "gravity") if way != "npz" else ()
        assert all(again[key] == written[key] for key in keys), way
    # Fitted masses are those of the file, not the row sums of the mesh.
    whole = {"name": "w", "objective": "whole", "masses": 2, "loads": ["a"]}
    del scene["motion"]
    report = sf.run(scene | {"fit": [whole]}, out=tmp_path / "whole")
    written = json.loads((tmp_path / "whole" / "w.json").read_text())
    assert report.networks["w"].masses == pytest.approx(written["masses"], rel=1e-15)
    plain = sf.fit(mesh, sf.Material(2e4, 0.3, density=1100)).masses
    assert np.abs(report.networks["w"].masses - plain).max() > 1e-3 * plain.max()
    # Outside of a scene they are fitted as well.
    alone = sf.whole(mesh, sf.Material(2e4, 0.3, density=1100), "xmin", masses=2)
    assert alone.masses.sum() == pytest.approx(plain.sum(), rel=1e-6)


def test_sheets_that_bend_are_pickled():
    scene = {
        "mesh": {"box": {"element": "tri3", "size": [0.04, 0.02], "cells": [4, 2]}, "space": 3},
        "material": {"young": 1e6, "poisson": 0.3, "density": 1000, "thickness": 0.001, "bending": "plate"},
        "fit": [{"objective": "offdiag", "bending": "hinges", "name": "h"}, {"objective": "exact", "name": "d"}],
        "fix": [{"group": "xmin"}],
    }
    for net in sf.run(scene).networks.values():
        again = pickle.loads(pickle.dumps(net))
        assert len(again) == len(net) and again.points.shape == net.points.shape
        moved = net.points + 1e-3 * np.sin(7 * net.points[:, [1, 2, 0]])
        assert again.energy(moved[None]) == pytest.approx(net.energy(moved[None]), rel=1e-12)


def test_patches_know_what_is_held():
    mesh = sf.Mesh.box("tri3", size=[2.0, 1.0], cells=[8, 4])
    keys = {"shear": "edges", "volume": "patches"}
    material = {"young": 1e4, "poisson": 0.4999, "thickness": 0.01, "plane": "strain"}
    load = {"name": "lift", "group": "xmax", "force": [0, 0.1]}
    scene = {"mesh": mesh, "material": material, "fix": [{"group": "xmin"}], "load": [load], "fit": [{"objective": "exact", **keys}]}
    known = next(u for name, u in sf.run(scene).displacements["lift"].items() if name)
    net = sf.fit(mesh, sf.Material(**material), fix="xmin", **keys)
    found = net.solve("xmin", {"xmax": [0, 0.1]})
    assert np.abs(found - known).max() <= 1e-9 * np.abs(known).max()
    with pytest.warns(UserWarning, match="no point is held"):
        stiffer = sf.fit(mesh, sf.Material(**material), **keys).solve("xmin", {"xmax": [0, 0.1]})
    assert np.abs(stiffer).max() < 0.95 * np.abs(known).max()
    with pytest.raises(sf.SpringfitError, match="fix"):
        sf.fit(mesh, sf.Material(**material), "frobenius", fix="xmin")

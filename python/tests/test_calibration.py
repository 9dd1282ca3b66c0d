"""Moduli from measurements: against exact answers, other meshes and elements, and wrong input."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

import springfit as sf

FIX = [{"group": "zmin", "axes": ["z"]}, {"where": "x < 1e-6", "axes": ["x"]}, {"where": "y < 1e-6", "axes": ["y"]}]
PULL = {"pull": {"group": "zmax", "traction": [0, 0, 100]}}
#: A bar of E = 1e4 Pa and ν = 0.3 under a pull of 100 Pa.
STRAIN = np.array([-0.003, -0.003, 0.01])


def block(cells=(2, 2, 4)):
    return sf.Mesh.box("hex8", [1, 1, 2], list(cells))


def test_uniform_strain_gives_the_exact_moduli():
    mesh = block()
    found = sf.calibrate(mesh, sf.Material(2e4, 0.1), {"pull": mesh.points * STRAIN}, fix=FIX, loads=PULL, unknowns="moduli")
    body = found.regions["body"]
    assert body.young.value == pytest.approx(1e4, rel=1e-7) and body.poisson.value == pytest.approx(0.3, abs=1e-7)
    assert body.shear_modulus.value == pytest.approx(1e4 / 2.6, rel=1e-7)
    assert body.lam.value == pytest.approx(0.3e4 / (1.3 * 0.4), rel=1e-6)
    assert found.names == ["E of body", "nu of body"] and found.table.shape == (4, 7)


def test_places_inside_cells_and_partial_components():
    mesh, random = block(), np.random.default_rng(1)
    places = random.uniform([0.01, 0.01, 0.01], [0.99, 0.99, 1.99], (30, 3))
    moved = places * STRAIN
    moved[:10, :2] = np.nan
    moved[10:20, 2] = np.nan
    found = sf.calibrate(mesh, sf.Material(2e4, 0.1), {"pull": (places, moved)}, fix=FIX, loads=PULL, unknowns="moduli")
    assert found.regions["body"].young.value == pytest.approx(1e4, rel=1e-6)
    assert found.regions["body"].poisson.value == pytest.approx(0.3, abs=1e-6)
    assert found.record["measurements"] == 10 + 20 + 30


def test_forces_give_moduli_where_displacements_are_prescribed():
    loads = {"stretch": {"group": "zmax", "displacement": ["free", "free", 0.02]}}
    mesh = block()
    # The face of 1 m² is pulled by 100 N.
    seen = {"stretch": {"displacements": mesh.points * STRAIN, "forces": {"zmax": [np.nan, np.nan, 100.0]}}}
    found = sf.calibrate(mesh, sf.Material(3e4, 0.1), seen, fix=FIX, loads=loads, unknowns="moduli")
    assert found.regions["body"].young.value == pytest.approx(1e4, rel=1e-6)
    assert found.regions["body"].poisson.value == pytest.approx(0.3, abs=1e-6)
    # Displacements alone do not see Young's modulus.
    blind = sf.calibrate(mesh, sf.Material(3e4, 0.1), {"stretch": mesh.points * STRAIN}, fix=FIX, loads=loads, unknowns="moduli")
    assert any("E of body" in names for names in blind.hardly_seen)
    assert blind.regions["body"].young.interval is None


def test_noise_is_told_by_interval_chi_square_and_correlation():
    mesh, random = block(), np.random.default_rng(2)
    sigma = 2e-4
    held = 0
    for _ in range(20):
        moved = mesh.points * STRAIN + sigma * random.normal(size=mesh.points.shape)
        found = sf.calibrate(mesh, sf.Material(1e4, 0.2), {"pull": moved}, noise=sigma, fix=FIX, loads=PULL, unknowns="moduli", refinements=0)
        low, high = found.regions["body"].young.interval
        held += low < 1e4 < high
        assert 0.7 < found.misfit < 1.3 and 0 < found.probability < 1
        assert found.by_noise_alone and any("by noise alone" in note for note in found.notes)
        assert np.allclose(found.correlations, found.correlations.T) and np.allclose(np.diag(found.correlations), 1)
    assert held >= 16


def test_a_body_that_the_model_does_not_describe_is_told():
    mesh = block()
    moved = mesh.points * STRAIN
    moved[:, 2] += 0.002 * np.sin(3 * mesh.points[:, 2])
    found = sf.calibrate(mesh, sf.Material(1e4, 0.3), {"pull": moved}, noise=1e-4, fix=FIX, loads=PULL)
    assert found.is_unexplained and found.misfit > 2


def test_large_deformation_with_a_law():
    mesh = block((1, 1, 2))
    loads = {"pull": {"group": "zmax", "traction": [0, 0, 3000]}}
    # Of the shipped law neo-hookean: the stretches that make the first Piola stress (0, 0, 3000).
    young, poisson = 1e4, 0.3
    mu, lam = young / 2.6, young * poisson / (1.3 * 0.4)

    def stress(stretch):
        a, c = stretch
        j = a * a * c
        return np.array([mu * (a - 1 / a) + lam * np.log(j) / a, mu * (c - 1 / c) + lam * np.log(j) / c - 3000])

    from scipy.optimize import fsolve

    a, c = fsolve(stress, [0.95, 1.3], xtol=1e-13)
    moved = mesh.points * [a - 1, a - 1, c - 1]
    found = sf.calibrate(
        mesh, sf.Material(1.3e4, 0.2), {"pull": moved}, fix=FIX, loads=loads, unknowns="moduli", law="neo-hookean", refinements=0
    )
    assert found.regions["body"].young.value == pytest.approx(1e4, rel=1e-4)
    assert found.regions["body"].poisson.value == pytest.approx(0.3, abs=1e-4)


def two_regions():
    mesh = block((2, 2, 4))
    z = mesh.points[:, 2]
    groups = {**mesh.groups, "lower": z < 1.001, "upper": z > 0.999}
    return sf.Mesh(mesh.points, mesh.cells, groups)


def test_known_regions_keep_their_moduli():
    mesh = two_regions()
    young = np.where(mesh.points[:, 2] < 1, 1, 0)
    z = np.where(young, mesh.points[:, 2] * 0.01, 0.01 + (mesh.points[:, 2] - 1) * 0.0025)
    moved = np.full(mesh.points.shape, np.nan)
    moved[:, 2] = z
    guess = {"lower": sf.Material(1e4, 0.0), "upper": sf.Material(1e4, 0.0)}
    found = sf.calibrate(mesh, guess, {"pull": moved}, fix=FIX, loads=PULL, known=["lower"])
    assert found.names == ["E of upper"]
    assert found.regions["upper"].young.value == pytest.approx(4e4, rel=1e-6)
    assert found.regions["lower"].young.interval is None


WRONG = [
    ({"measured": {"pull": (np.array([[1.3, 0.5, 0.5]]), np.ones((1, 3)))}}, "places in the body"),
    ({"measured": {"push": np.zeros((45, 3))}}, "loads of pull"),
    ({"measured": {"pull": np.zeros((3, 3))}}, "shape"),
    ({"measured": {"pull": np.full((45, 3), np.nan)}}, "measured"),
    ({"measured": {"pull": np.full((45, 3), np.inf)}}, "finite"),
    ({"measured": {"pull": {"moved": np.zeros((45, 3))}}}, "displacements"),
    ({"noise": -1.0}, "above zero"),
    ({"unknowns": "density"}, "young"),
    ({"refinements": 9}, "0 to 3"),
    ({"known": ["skull"]}, "skull"),
    ({"regions": {"skull": sf.Material(1e4, 0.3)}}, "skull"),
    ({"regions": None}, "Material"),
    ({"unknowns": "cells"}, "noise"),
    ({"prior": "edges"}, "cells"),
    ({"loads": {}}, "loads"),
]


@pytest.mark.parametrize("change, words", WRONG)
def test_wrong_input_is_refused_with_what_was_expected(change, words):
    mesh = block()
    keys = {"regions": sf.Material(1e4, 0.3), "measured": {"pull": mesh.points * STRAIN}, "fix": FIX, "loads": PULL, **change}
    with pytest.raises(sf.SpringfitError) as error:
        sf.calibrate(mesh, keys.pop("regions"), keys.pop("measured"), **keys)
    assert words in str(error.value), error.value


SCENE = """
[mesh]
box = { element = "hex8", size = [1, 1, 2], cells = [2, 2, 4] }
[[material]]
name = "all of it"
young = 2e4
poisson = 0.3
[[fix]]
group = "zmin"
axes = ["z"]
[[fix]]
where = "x < 1e-6"
axes = ["x"]
[[fix]]
where = "y < 1e-6"
axes = ["y"]
[[load]]
name = "pull"
group = "zmax"
traction = [0, 0, 100]
measured = { file = "seen.csv" }
[calibrate]
"""


def test_a_scene_gives_the_same(tmp_path):
    mesh, random = block(), np.random.default_rng(3)
    places = random.uniform([0.01, 0.01, 0.01], [0.99, 0.99, 1.99], (20, 3))
    moved = places * STRAIN * random.normal(1, 0.01, (20, 3))
    rows = "\n".join(",".join(map(repr, map(float, row))) for row in np.hstack([places, moved]))
    (tmp_path / "seen.csv").write_text("x,y,z,ux,uy,uz\n" + rows + "\n")
    (tmp_path / "scene.toml").write_text(SCENE)
    own = sf.calibrate(tmp_path / "scene.toml", unknowns="moduli")
    other = sf.calibrate(mesh, sf.Material(2e4, 0.3), {"pull": (places, moved)}, fix=FIX, loads=PULL, unknowns="moduli")
    assert list(own.regions) == ["all of it"]
    for key in ("young", "poisson"):
        a, b = getattr(own.regions["all of it"], key), getattr(other.regions["body"], key)
        assert a.value == pytest.approx(b.value, rel=1e-12) and a.interval == pytest.approx(b.interval, rel=1e-9)


def bench():
    path = Path(__file__).parent.parent / "benches" / "calibration.py"
    spec = importlib.util.spec_from_file_location("calibration_bench", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_intervals_hold_the_truth_of_another_mesh_and_element():
    pytest.importorskip("skfem")
    own = bench()
    # What more cells and layers change of the data is far below the intervals, of 1 %.
    assert own.error_of_data("bracket", 0) < 2e-4
    found = own.study(["bracket"], range(5), noises=(0.0, 0.05), kinds=("interior",))
    rows = sum(row["intervals"] * row["held"] for row in found.values())
    # Of 20 intervals of 95 %, fewer than 16 hold with a chance of 0.3 %.
    assert rows >= 16, found


@pytest.mark.long
def test_intervals_hold_the_truth_of_solids():
    pytest.importorskip("skfem")
    found = bench().study(["block"], range(2), noises=(0.01,), kinds=("surface",))
    # Of 4 intervals of 95 %, fewer than 2 hold with a chance of 0.05 %.
    assert sum(row["intervals"] * row["held"] for row in found.values()) >= 2, found


@pytest.mark.long
def test_intervals_of_a_clamped_nearly_incompressible_bar_hold():
    pytest.importorskip("skfem")
    own = bench()
    # What is left of the error of the data is far below the intervals.
    assert own.error_of_data("bar", 0) < 1e-3
    found = own.study(["bar"], range(3), noises=(0.0, 0.05), kinds=("interior",))
    # Of 12 intervals of 95 %, fewer than 8 hold with a chance of 0.02 %.
    assert sum(row["intervals"] * row["held"] for row in found.values()) >= 8, found


@pytest.mark.long
def test_intervals_of_a_block_with_an_inclusion_hold():
    pytest.importorskip("skfem")
    found = bench().study(["inclusion"], range(2), noises=(0.01,), kinds=("surface", "interior"))
    # Of 8 intervals of 95 %, fewer than 5 hold with a chance of 0.04 %.
    assert sum(row["intervals"] * row["held"] for row in found.values()) >= 5, found


def test_supports_and_noise_are_written_as_in_scenes():
    mesh = block()
    held = np.array([0.0, 0.0, 1.0])  # what the lower side does not move
    moved = mesh.points * STRAIN * held + 1e-6 * np.random.default_rng(5).normal(size=mesh.points.shape)
    of = dict(loads=PULL, refinements=0)
    plain = sf.calibrate(mesh, sf.Material(2e4, 0.3), {"pull": moved}, noise=1e-4, fix=[{"group": "zmin"}], **of)
    words = sf.calibrate(mesh, sf.Material(2e4, 0.3), {"pull": moved}, noise="0.1 mm", fix="zmin", **of)
    assert words.record["regions"] == plain.record["regions"] and words.misfit == plain.misfit
    alone = sf.calibrate(mesh, sf.Material(2e4, 0.3), {"pull": moved}, noise={"pull": "0.1 mm"}, fix={"group": "zmin"}, **of)
    assert alone.record["regions"] == plain.record["regions"]
    for noise in ("0.1 kPa", "much"):
        with pytest.raises(sf.SpringfitError, match="^noise of pull: expected a length"):
            sf.calibrate(mesh, sf.Material(2e4, 0.3), {"pull": moved}, noise=noise, fix="zmin", **of)
    with pytest.raises(sf.SpringfitError, match="^fix: expected names of groups"):
        sf.calibrate(mesh, sf.Material(2e4, 0.3), {"pull": moved}, fix=[3], **of)


def test_errors_of_arguments_name_no_file():
    mesh = block()
    with pytest.raises(sf.SpringfitError) as caught:
        sf.calibrate(mesh, sf.Material(2e4, 0.3), {"pull": mesh.points}, fix="zmim", loads=PULL)
    assert "scene.toml" not in str(caught.value) and caught.value.file is None and caught.value.line is None
    assert caught.value.key.startswith("fix[0]") and 'did you mean "zmin"?' in str(caught.value)
    with pytest.raises(sf.SpringfitError) as caught:
        sf.calibrate(mesh, sf.Material(2e4, 0.3), {"pull": mesh.points}, fix="zmin", loads=PULL, known=["body"])
    assert "scene.toml" not in str(caught.value) and caught.value.file is None


def test_residuals_far_beyond_the_noise_are_not_trusted():
    mesh, random = block(), np.random.default_rng(4)
    sigma = 1e-4
    moved = mesh.points * STRAIN + sigma * random.normal(size=mesh.points.shape)
    given = dict(fix=FIX, loads=PULL, unknowns="moduli", refinements=0)
    right = sf.calibrate(mesh, sf.Material(2e4, 0.1), {"pull": moved}, noise=sigma, **given)
    wrong = sf.calibrate(mesh, sf.Material(2e4, 0.1), {"pull": moved}, noise=1e-4 * sigma, **given)
    assert right.is_trusted and not any("NOT TRUSTED" in note for note in right.notes)
    assert not wrong.is_trusted and wrong.notes[0].startswith("NOT TRUSTED: residuals are ")
    assert wrong.misfit == pytest.approx(1e4 * right.misfit, rel=1e-6)
    for key in ("young", "poisson"):
        # The deviations are those of the residuals: as many times those by the stated noise as residuals are beyond it.
        a, b = getattr(right.regions["body"], key), getattr(wrong.regions["body"], key)
        assert b.deviation == pytest.approx(a.deviation * right.misfit, rel=1e-6)
        assert b.interval[1] > b.interval[0]


def test_progress_has_no_end_where_none_is_known():
    told = []
    mesh = block()
    sf.calibrate(mesh, sf.Material(2e4, 0.3), {"pull": mesh.points * STRAIN}, fix=FIX, loads=PULL, refinements=0, progress=lambda *step: told.append(step))
    steps = [step for step in told if step[0] == "calibrate"]
    assert steps and all(total == 0 for _, _, total in steps)
    assert [done for _, done, _ in steps] == sorted(done for _, done, _ in steps)


def test_measurements_that_do_not_belong_together_are_told_without_a_noise():
    mesh, random = block(), np.random.default_rng(6)
    given = dict(fix=FIX, loads=PULL, unknowns="moduli", refinements=0)
    moved = mesh.points * STRAIN
    right = sf.calibrate(mesh, sf.Material(2e4, 0.1), {"pull": moved}, **given)
    assert right.is_trusted and right.record["explained"] == pytest.approx(1.0, abs=1e-9)
    assert any("explains 100 % of what was measured" in note for note in right.notes)
    mixed = sf.calibrate(mesh, sf.Material(2e4, 0.1), {"pull": moved[random.permutation(len(moved))]}, **given)
    assert not mixed.is_trusted and mixed.notes[0].startswith("NOT TRUSTED: the body explains ")
    # The same from the residuals that the report has; displacements have one weight under one load.
    load = mixed.record["loads"][0]
    assert mixed.record["explained"] == pytest.approx(1 - (load["residual"] / load["size"]) ** 2, abs=1e-9)


@pytest.mark.parametrize("noise", [None, 1e-6])
def test_measurements_of_what_is_held_are_compared_with_the_support(noise):
    mesh = block()
    given = dict(fix="zmin", loads=PULL, refinements=0, noise=noise)
    moved = np.zeros(mesh.points.shape)
    moved[:, 2] = 0.01 * mesh.points[:, 2]
    on = mesh.points[:, 2] < 1e-9
    for slip, is_trusted, words in ((0.0, True, None), (4e-4, True, "4.000e-4 m from where it is held"), (4e-3, False, "does [[fix]] hold")):
        seen = moved + slip * on[:, None] * [0, 0, 1]
        found = sf.calibrate(mesh, sf.Material(1e4, 0.0), {"pull": seen}, **given)
        load = found.record["loads"][0]
        assert load["held"] == 3 * on.sum() and load["held_residual"] == pytest.approx(slip)
        told = [note for note in found.notes if "where it is held" in note]
        assert found.is_trusted == is_trusted, found.notes
        assert len(told) == (words is not None) and (words is None or words.split(" m ")[-1] in told[0]), found.notes
    alone = np.where(on[:, None], moved, np.nan)
    with pytest.raises(sf.SpringfitError, match="those of what is held alone"):
        sf.calibrate(mesh, sf.Material(1e4, 0.0), {"pull": alone}, **given)


def test_the_law_of_a_material_is_that_of_the_search():
    mesh = sf.Mesh.box("hex8", size=[1, 1, 2], cells=[2, 2, 4])
    fix = [{"group": "zmin", "axes": ["z"]}, {"where": "x < 1e-6", "axes": ["x"]}, {"where": "y < 1e-6", "axes": ["y"]}]
    loads = {"pull": {"group": "zmax", "traction": [0, 0, 5000]}}
    scene = {"mesh": mesh, "material": {"young": 1e4, "poisson": 0.3, "law": "neo-hookean"}, "fix": fix, "fit": [{"objective": "exact"}]}
    seen = sf.run({**scene, "load": [{"name": "pull", **loads["pull"]}]}).displacements["pull"][""]
    material = sf.Material(2e4, 0.3, law="neo-hookean")
    found = sf.calibrate(mesh, material, {"pull": seen}, noise=1e-4, fix=fix, loads=loads)
    assert float(next(iter(found.regions.values())).young) == pytest.approx(1e4, rel=1e-3)
    with pytest.raises(sf.SpringfitError, match="law"):
        sf.calibrate(mesh, material, {"pull": seen}, noise=1e-4, fix=fix, loads=loads, law="saint-venant-kirchhoff")
    by_cell = sf.Material(np.full(16, 2e4), 0.3)
    with pytest.raises(sf.SpringfitError, match="array by cell"):
        sf.calibrate(mesh, by_cell, {"pull": seen}, noise=1e-4, fix=fix, loads=loads)

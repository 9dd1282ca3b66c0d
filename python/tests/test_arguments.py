"""Arguments of fits, supports and studies: what is wrong is named, and nothing that is given is passed over."""

import itertools
import re
from pathlib import Path

import numpy as np
import pytest

import springfit as sf
from conftest import raised, square

MATERIAL = sf.Material(young=1e4, poisson=0.3)
SCENE = square(2)
POINTS = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]


def box():
    return sf.Mesh.box("quad4", size=[1.0, 1.0], cells=[2, 2])


def net():
    return sf.fit(box(), MATERIAL)


def masked(shape):
    return np.ma.array(np.zeros(shape), mask=np.eye(*shape[:2]) if len(shape) == 2 else np.arange(shape[0]) == 0)


@pytest.mark.parametrize("call", [sf.fit, sf.stiffness, sf.mass, lambda *given: sf.whole(*given, fix="xmin")])
def test_bodies_and_materials_are_named(call):
    raised(lambda: call(np.zeros((4, 2)), MATERIAL), "mesh")
    raised(lambda: call(box(), {"young": 1e4, "poisson": 0.3}), "material")
    raised(lambda: call(box(), None), "material")


@pytest.mark.parametrize(
    "keys, key",
    [
        ({"young": "10 apples"}, "young"),
        ({"young": b"10 kPa"}, "young"),
        ({"young": None}, "young"),
        ({"poisson": [[0.3]]}, "poisson"),
        ({"poisson": {"a": 1}}, "poisson"),
        ({"density": np.ma.masked}, "density"),
        ({"thickness": 1j}, "thickness"),
        ({"area": True}, "area"),
        ({"plane": 3}, "plane"),
    ],
)
def test_values_of_materials_are_numbers(keys, key):
    assert raised(lambda: sf.Material(**{"young": 1e4, "poisson": 0.3, **keys}), key).startswith(f"{key}: expected")


def test_any_two_constants_state_an_isotropic_material():
    all_constants = {"young": 1e4, "poisson": 0.25, "shear_modulus": 4e3, "bulk_modulus": 2e4 / 3, "lam": 4e3}
    for pair in itertools.combinations(all_constants, 2):
        own = sf.Material.isotropic(**{key: all_constants[key] for key in pair}, density=1e3)
        assert (own.young, own.poisson) == pytest.approx((1e4, 0.25)) and own.density == 1e3
    assert sf.Material.isotropic(lam="-0.6 kPa", shear_modulus=1e3).poisson < 0
    # λ + 2 μ/3 is the bulk modulus.
    for lam, shear_modulus in [(1.0, -1.0), (1.0, 0.0), (-2 / 3, 1.0), (-1.0, 1.0), (np.nan, 1.0), ("stiff", 1.0)]:
        with pytest.raises(sf.SpringfitError, match="lambda"):
            sf.Material.isotropic(lam=lam, shear_modulus=shear_modulus)
    for given in [{}, {"lam": 1.0}, {"lam": 1.0, "young": 1.0, "poisson": 0.3}]:
        raised(lambda: sf.Material.isotropic(**given), "material")
    raised(lambda: sf.Material.isotropic(young="1e4*(1 + z)", poisson=0.3), "young")


@pytest.mark.parametrize(
    "fix",
    [np.array([0, 1], "m8[s]"), np.ma.array([0, 1, 2], mask=[0, 0, 1]), [0.0, 1.0], [[0], [1, 2]], [9], [-1], [True, False], "nowhere", 3, None],
)
def test_wrong_supports_are_named(fix):
    raised(lambda: net().solve(fix=fix), "fix")


def test_meshes_without_groups_say_so():
    mesh = sf.Mesh(POINTS, {"tri3": [[0, 1, 2]]})
    assert "has no groups" in raised(lambda: sf.fit(mesh, MATERIAL).solve(fix="xmin"), "fix")


def test_masks_and_ragged_lists_are_no_positions():
    own, shape = net(), (9, 2)
    for call in (own.energy, own.forces, own.stiffness):
        raised(lambda: call(masked(shape)), "x")
        raised(lambda: call([[0.0, 0.0], [1.0]]), "x")
        raised(lambda: call(np.zeros(shape).astype("m8[s]")), "x")
    raised(lambda: own.solve(fix="xmin", forces=masked(shape)), "forces")
    raised(lambda: own.export("npz", "none", gravity=masked((2,))), "gravity")
    assert not Path("none").exists()


def test_displacements_of_what_is_not_held_are_named():
    own, d = net(), np.zeros((9, 2))
    d[box().groups["xmin"], 0] = 0.1
    u = own.solve(fix="xmin", displacement=d)
    assert np.allclose(u, [0.1, 0.0])
    d[[4, 8], 1] = 0.1
    assert "at 2 points: 4, 8" in raised(lambda: own.solve(fix="xmin", displacement=d), "displacement")
    # A component that is not held.
    flags = np.zeros((9, 2), bool)
    flags[:, 0] = flags[0] = True
    d = np.zeros((9, 2))
    d[3, 1] = 1.0
    assert "at 1 points: 3" in raised(lambda: own.solve(fix=flags, displacement=d), "displacement")


def test_functions_give_no_masked_values():
    mesh = sf.Mesh.box("tri3", size=[1.0, 1.0], cells=[1, 1])
    hidden = lambda values: np.ma.array(values, mask=np.arange(np.size(values)).reshape(np.shape(values)) == 0)
    keys = {"shapes": {"count": 10, "stretch": 0.1}}
    raised(lambda: sf.sampled(mesh, MATERIAL, lambda F: hidden(np.einsum("nij,nij->n", F, F)), **keys), "law")
    raised(lambda: sf.sampled(mesh, MATERIAL, stress=lambda F: hidden(F), **keys), "stress")
    raised(lambda: sf.sampled(mesh, MATERIAL, "neo-hookean", force=lambda s, k: hidden(k * s), **keys), "force")


@pytest.mark.parametrize("progress", [3, "yes", [print]])
def test_progress_is_yes_no_or_a_function(progress):
    raised(lambda: sf.fit(box(), MATERIAL, progress=progress), "progress")
    raised(lambda: sf.run(SCENE, progress=progress), "progress")


TRI = sf.Element("tri3")


@pytest.mark.parametrize(
    "call, key",
    [
        (lambda file: sf.compare(TRI, set={"material.poisson": 0.1}), "set"),
        (lambda file: sf.compare(TRI, folder="."), "folder"),
        (lambda file: sf.compare(SCENE, iterations=0), "iterations"),
        (lambda file: sf.compare(SCENE, shapes=-5), "shapes"),
        (lambda file: sf.compare(SCENE, poisson=0.3), "poisson"),
        (lambda file: sf.compare(SCENE, plane="stress"), "plane"),
        (lambda file: sf.compare(TRI, shapes=-5), "shapes"),
        (lambda file: sf.compare(TRI, shapes=2.5), "shapes"),
        (lambda file: sf.compare(TRI, poisson="0.3"), "poisson"),
        (lambda file: sf.compare(TRI, plane=1), "plane"),
        (lambda file: sf.stability(TRI, set={"foo": 1}), "set"),
        (lambda file: sf.stability(TRI, folder="."), "folder"),
        (lambda file: sf.stability(set={"foo": 1}), "set"),
        (lambda file: sf.run(file, folder="."), "folder"),
        (lambda file: sf.compare(file, folder="."), "folder"),
        (lambda file: sf.stability(file, folder="."), "folder"),
        (lambda file: sf.sweep(file, folder="."), "folder"),
        (lambda file: sf.converge(file, folder="."), "folder"),
        (lambda file: sf.converge(file, truth=file, folder="."), "folder"),
        (lambda file: sf.converge(SCENE, levels=-1), "levels"),
        (lambda file: sf.converge(SCENE, levels="3"), "levels"),
        (lambda file: sf.run(None), "scene"),
        (lambda file: sf.run(SCENE, set=["material.poisson"]), "set"),
    ],
)
def test_arguments_of_studies_are_named(call, key, scenes):
    pytest.importorskip("pandas")
    raised(lambda: call(scenes / "square_quad.toml"), key)


def test_the_folder_of_a_truth_is_that_of_its_dictionary(scenes, monkeypatch):
    from springfit import _core

    seen = []
    monkeypatch.setattr(_core, "converge", lambda *given: seen.append(given) or "{}")
    file = scenes / "square_quad.toml"
    sf.converge(file, truth=SCENE, folder=scenes)
    sf.converge(SCENE, truth=file, folder=scenes)
    assert [(scene[1], truth[1]) for scene, _, truth, _ in seen] == [(Path("."), scenes), (scenes, Path("."))]


def test_the_programs_of_exports_are_those_of_the_book():
    page = (Path(__file__).resolve().parents[2] / "docs/src/reference/exports.md").read_text()
    known = re.findall(r"^\| `(\w+)` \|", page.split("\n## ")[0], re.MULTILINE)
    words = re.search(r"to: The program: (.*)\n", sf.Network.export.__doc__).group(1)
    assert re.findall(r'"(\w+)"', words) == known and len(known) > 5


def test_volumes_of_whole_cells_are_sums_over_the_quadrature():
    mesh = sf.Mesh.box("hex8", size=[1.0, 0.8, 0.7], cells=[1, 1, 1])
    rng = np.random.default_rng(3)
    mesh = sf.Mesh(mesh.points + 0.1 * rng.uniform(-1, 1, mesh.points.shape), mesh.cells)
    own = sf.fit(mesh, MATERIAL, "offdiag", springs=["edge", "bulk"])
    (bulk,) = own.contents
    corners = sf.Element("hex8").positions
    volume = 0.0
    for xi in np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T / np.sqrt(3):
        factors = (1 + corners * xi) / 2
        slopes = np.stack([corners[:, k] / 2 * np.delete(factors, k, axis=1).prod(axis=1) for k in range(3)], axis=1)
        volume += np.linalg.det(own.points[bulk["points"][0]].T @ slopes)
    assert bulk["kind"] == "volume" and bulk["rest"] == pytest.approx([volume], rel=1e-12)


@pytest.mark.parametrize("name, is_hrz", [("tet4", False), ("hex8", False), ("tet10", True), ("tri6", True)])
def test_masses_are_row_sums_or_those_of_hrz(name, is_hrz):
    d = sf.Element(name).dimension
    mesh = sf.Mesh.box(name, size=[1.0, 0.8, 0.7][:d], cells=[2, 1, 1][:d])
    material = sf.Material(1e4, 0.3, density=7.0)
    own = sf.fit(mesh, material, "offdiag").masses
    matrix = sf.mass(mesh, material, share=1.0 if is_hrz else 0.0)
    assert np.allclose(own, np.asarray(matrix.sum(axis=1)).ravel()[::d], rtol=1e-12)

"""Networks from arrays and files: what is given is what answers."""

import copy
import json
import pickle
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest

import springfit as sf

MATERIAL = sf.Material(young=1e4, poisson=0.3, density=1000.0)


def fitted(name="tet4", material=MATERIAL, **keys):
    d = sf.Element(name).dimension
    return sf.fit(sf.Mesh.box(name, size=[1.0, 0.8, 0.7][:d], cells=[3, 2, 2][:d]), material, **keys)


def networks():
    yield "tet4", fitted()
    yield "hex8", fitted("hex8")
    yield "tet10", fitted("tet10")
    yield "tri3", fitted("tri3")
    yield "quad4", fitted("quad4", objective="divergence")
    yield "offdiag", fitted("hex8", objective="offdiag", nonnegative=True)
    yield "patches", fitted(volume="patches")
    yield "bulk", fitted("quad4", objective="frobenius", springs=["edge", "diagonal", "bulk"])
    law = dict(springs=["edge"], force="k*s + k3*s^3", shapes={"count": 20})
    yield "law", sf.sampled(sf.Mesh.box("tet4", size=[1, 1, 1], cells=[1, 1, 1]), MATERIAL, "neo-hookean", **law)
    surface = sf.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0.5], [0, 1, 0.2]], {"tri3": [[0, 1, 2], [0, 2, 3]]})
    yield "membrane", sf.fit(surface, sf.Material(1e4, 0.3, thickness=0.01, density=1e3))


NETWORKS = dict(networks())


def same(one, other, exactly=True):
    """Equal answers at rest and elsewhere."""
    rng = np.random.default_rng(1)
    assert len(one) == len(other)
    for x in (one.points, one.points + 0.05 * rng.uniform(-1, 1, one.points.shape)):
        close = np.array_equal if exactly else lambda a, b: np.allclose(a, b, rtol=1e-10, atol=1e-10 * np.abs(a).max())
        assert close(one.forces(x), other.forces(x))
        assert one.energy(x) == pytest.approx(other.energy(x), rel=0 if exactly else 1e-10)
        a, b = one.stiffness(x), other.stiffness(x)
        assert abs(a - b).max() <= (0 if exactly else 1e-10) * abs(a).max()


@pytest.mark.parametrize("name", NETWORKS)
def test_arrays_are_made_once_and_read_only(name):
    net = NETWORKS[name]
    for attribute in ("points", "springs", "constants", "rest", "masses"):
        array = getattr(net, attribute)
        assert array is getattr(net, attribute)
        with pytest.raises(ValueError):
            array[:] = 0
    for group, again in zip(net.contents, net.contents):
        for key, value in group.items():
            assert value is again[key]
            if isinstance(value, np.ndarray):
                with pytest.raises(ValueError):
                    value[:] = 0
        assert group["points"].dtype == np.int64
    assert net.springs.dtype == net.mesh.cells[0][1].dtype == np.int64
    assert str(len(net)) in repr(net)


@pytest.mark.parametrize("name", NETWORKS)
def test_arrays_make_the_network_again(name):
    net = NETWORKS[name]
    again = sf.Network(net.points, net.springs, net.constants, rest=net.rest, contents=net.contents, masses=net.masses, mesh=net.mesh)
    # Patches of different numbers of points are gathered, which changes the order of sums.
    same(net, again, name != "patches")
    assert np.array_equal(again.masses, net.masses) and again.mesh is net.mesh
    # Shipped elements are known without the mesh; other dictionaries say the same.
    bare = sf.Network(net.points.tolist(), net.springs.astype(np.int32), net.constants, rest=net.rest, contents=net.contents)
    same(net, bare, name != "patches")
    assert bare.masses is None and bare.mesh is None and bare.status == "given" and "given" in bare._repr_html_()


@pytest.mark.parametrize("name", NETWORKS)
@pytest.mark.parametrize("copied", [lambda net: pickle.loads(pickle.dumps(net)), copy.copy, copy.deepcopy])
def test_pickles_and_copies_are_the_network(name, copied):
    net = NETWORKS[name]
    again = copied(net)
    same(net, again, name != "patches")
    assert (again.name, again.status, again.notes) == (net.name, net.status, net.notes)
    assert again.statistics["seconds"] == net.statistics["seconds"] and repr(again) == repr(net)
    assert (again.sampled is None) == (net.sampled is None)
    assert np.array_equal(again.masses, net.masses)
    assert {k: v.tolist() for k, v in again.mesh.groups.items()} == {k: v.tolist() for k, v in net.mesh.groups.items()}


def test_networks_come_back_from_other_processes():
    mesh = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[2, 2, 2])
    with ProcessPoolExecutor(1) as pool:
        found = pool.submit(sf.fit, mesh, MATERIAL).result()
    same(found, sf.fit(mesh, MATERIAL))


@pytest.mark.parametrize("name", NETWORKS)
def test_files_hold_the_network(name, tmp_path):
    net = NETWORKS[name]
    path = tmp_path / "net.json"
    net.save(path)
    again = sf.Network.load(path)
    same(net, again)
    assert again.name == net.name and np.array_equal(again.masses, net.masses)
    assert again.mesh is not None and np.array_equal(again.mesh.cells[0][1], net.mesh.cells[0][1])
    again.save(tmp_path / "again.json")
    own, other = (json.loads(file.read_text()) for file in (path, tmp_path / "again.json"))
    assert [{**s, "groups": []} for s in own["springs"]] == [{**s, "groups": []} for s in other["springs"]]


@pytest.mark.parametrize("name", ["tet4", "tri3", "offdiag"])
def test_arrays_of_files_hold_simplices(name, tmp_path):
    net = NETWORKS[name]
    net.save(tmp_path / "net.npz")
    again = sf.Network.load(tmp_path / "net.npz")
    same(net, again, exactly=False)
    assert np.array_equal(again.masses, net.masses) and (again.mesh is not None) == (name != "offdiag")
    with np.load(tmp_path / "net.npz") as arrays:
        named = {("constants" if key == "k" else key): arrays[key] for key in arrays.files}
    np.savez(tmp_path / "other.npz", **named)
    same(net, sf.Network.load(tmp_path / "other.npz"), exactly=False)


def test_own_elements_are_known_by_their_file(tmp_path):
    text = open_text("quad4").replace('name = "quad4"', 'name = "own4"')
    element = sf.Element.parse(text)
    mesh = sf.Mesh(sf.Mesh.box("quad4", size=[1, 1], cells=[2, 2]).points, {element: sf.Mesh.box("quad4", size=[1, 1], cells=[2, 2]).cells[0][1]})
    net = sf.fit(mesh, MATERIAL, "divergence")
    same(net, pickle.loads(pickle.dumps(net)))
    net.save(tmp_path / "net.json")
    same(net, sf.Network.load(tmp_path / "net.json", elements=[element]))


def open_text(name):
    from pathlib import Path

    return (Path(__file__).parents[2] / "elements" / f"{name}.toml").read_text()


def test_a_network_of_springs_alone_answers():
    """A triangle of equal springs, with closed forms."""
    points = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, 0.75**0.5]])
    net = sf.Network(points, [[0, 1], [2, 1], [2, 0]], [5.0, 5.0, 5.0])
    assert net.springs.tolist() == [[0, 1], [1, 2], [0, 2]] and np.allclose(net.rest, 1.0)
    assert net.energy() == pytest.approx(0, abs=1e-30) and len(net) == 3
    assert net.energy(2 * points) == pytest.approx(3 * 5.0 / 2)
    assert np.allclose(net.stiffness().toarray()[:2, :2], 5 * (np.diag([1, 0]) + np.outer([0.5, 0.75**0.5], [0.5, 0.75**0.5])))
    fix = [[True, True], [False, True], [False, False]]
    u = net.solve(fix, [[0, 0], [0, 0], [0, -1e-3]])
    # The struts carry 1e-3/√3 each, the tie half of that.
    assert u[1, 0] == pytest.approx(1e-3 / (2 * 3**0.5) / 5, rel=1e-9)
    assert np.allclose(net.equilibrium(fix, [[0, 0], [0, 0], [0, -1e-7]]) - points, 1e-4 * u, rtol=1e-4, atol=1e-13)
    with pytest.raises(sf.SpringfitError, match="has no mesh"):
        net.solve("xmin")
    with pytest.raises(sf.SpringfitError, match="has no mesh"):
        net.solve(fix, {"top": [0, 1]})
    with pytest.raises(sf.SpringfitError) as error:
        net.solve([0])
    assert error.value.key == "fix"


def test_a_network_without_a_mesh_is_exported(tmp_path):
    net = NETWORKS["tet4"]
    bare = sf.Network(net.points, net.springs, net.constants, rest=net.rest, contents=net.contents, masses=net.masses)
    lengths = NETWORKS["offdiag"]
    lengths = sf.Network(lengths.points, lengths.springs, lengths.constants, rest=lengths.rest, masses=lengths.masses)
    assert bare.export("npz", tmp_path / "arrays") and lengths.export("lammps", tmp_path / "lammps")
    for ending in ("json", "npz", "csv", "vtu"):
        bare.save(tmp_path / f"net.{ending}")
    same(bare, sf.Network.load(tmp_path / "net.json"))


def test_contents_without_a_table_are_those_of_simplices():
    net = NETWORKS["tet4"]
    plain = [{key: group[key] for key in ("kind", "points", "constants", "rest")} for group in net.contents]
    same(net, sf.Network(net.points, net.springs, net.constants, rest=net.rest, contents=plain))
    # Angles and areas in space have formulas.
    rng = np.random.default_rng(2)
    points = rng.uniform(-1, 1, (4, 3))
    groups = [{"kind": "angle", "points": [[0, 1, 2]], "constants": [3.0]}, {"kind": "area", "points": [[0, 1, 3]], "constants": [2.0]}]
    own = sf.Network(points, np.zeros((0, 2)), [], contents=groups)
    a, b = points[0] - points[1], points[2] - points[1]
    angle = np.arccos(a @ b / np.linalg.norm(a) / np.linalg.norm(b))
    area = np.linalg.norm(np.cross(points[1] - points[0], points[3] - points[0])) / 2
    rest = {group["kind"]: group["rest"][0] for group in own.contents}
    assert rest == pytest.approx({"angle": angle, "area": area}, rel=1e-12)
    assert own.energy(2 * points) == pytest.approx(2.0 * (3 * area) ** 2 / 2, rel=1e-12)


def test_other_constants_are_another_network():
    net = NETWORKS["tet4"]
    twice = net.with_constants(2 * net.constants, contents=[2 * group["constants"] for group in net.contents])
    x = net.points + 0.03 * np.random.default_rng(5).uniform(-1, 1, net.points.shape)
    assert np.allclose(twice.forces(x), 2 * net.forces(x), rtol=1e-12, atol=1e-12)
    assert np.array_equal(twice.rest, net.rest) and twice.mesh is net.mesh and np.array_equal(twice.masses, net.masses)
    same(net, twice.with_constants(net.constants, contents=[{"constants": group["constants"]} for group in net.contents]))
    long = net.with_constants(rest=net.rest + 0.1)
    assert np.array_equal(long.constants, net.constants) and np.allclose(long.rest, net.rest + 0.1)
    law = NETWORKS["law"]
    parameters = {key: 3 * value for key, value in law.contents[0]["parameters"].items()}
    assert np.allclose(law.with_constants(contents=[{"parameters": parameters}]).forces(1.1 * law.points), 3 * law.forces(1.1 * law.points))
    for keys, key in [
        (dict(constants=[1.0]), "constants"),
        (dict(constants=np.full(len(net.constants), np.nan)), "constants[0]"),
        (dict(contents=[]), None),
        (dict(contents=[None, None]), "contents"),
        (dict(contents=[[1.0]]), "contents[0].constants"),
        (dict(contents=[{"konstants": [1.0]}]), "contents[0].konstants"),
        (dict(contents=[{"parameters": {"a": [1.0]}}]), "contents[0].parameters.a"),
    ]:
        if key is None:
            same(net, net.with_constants(**keys))
            continue
        with pytest.raises(sf.SpringfitError) as error:
            net.with_constants(**keys)
        assert error.value.key == key, str(error.value)


POINTS = np.eye(4, 3)


@pytest.mark.parametrize(
    "given, key",
    [
        (dict(springs=[[0, 4]], constants=[1.0]), "springs"),
        (dict(springs=[[0, -1]], constants=[1.0]), "springs"),
        (dict(springs=[[2, 2]], constants=[1.0]), "springs[0]"),
        (dict(springs=[[0, 1, 2]], constants=[1.0]), "springs"),
        (dict(springs=[[0.0, 1.0]], constants=[1.0]), "springs"),
        (dict(springs=[[0, 1]], constants=[1.0, 2.0]), "constants"),
        (dict(springs=[[0, 1]], constants=[np.inf]), "constants[0]"),
        (dict(springs=[[0, 1]], constants=None), "constants"),
        (dict(springs=[[0, 1]], constants=["a"]), "constants"),
        (dict(springs=[[0, 1]], constants=[1.0], rest=[np.nan]), "rest[0]"),
        (dict(springs=[[0, 1]], constants=[1.0], masses=[1.0]), "masses"),
        (dict(springs=[[0, 1]], constants=[1.0], masses=[1, 1, 1, -1]), "masses[3]"),
        (dict(springs=[[0, 1]], constants=[1.0], contents={"kind": "volume"}), "contents"),
        (dict(springs=[[0, 1]], constants=[1.0], contents=[{"kind": "volume"}]), "contents[0].points"),
        (dict(springs=[[0, 1]], constants=[1.0], contents=[{"kind": "bulk", "points": [[0, 1, 2, 3]], "constants": [1]}]), "contents[0].kind"),
        (dict(springs=[[0, 1]], constants=[1.0], contents=[{"kind": "volume", "points": [[0, 1, 2, 4]], "constants": [1]}]), "contents[0].points"),
        (dict(springs=[[0, 1]], constants=[1.0], contents=[{"kind": "volume", "points": [[0, 1, 2, 3]], "constants": [1], "element": "x"}]), "contents[0].element"),
        (dict(springs=[[0, 1]], constants=[1.0], contents=[{"kind": "length", "points": [[0, 1]], "constants": [1], "law": "k*s"}]), "contents[0].parameters.k"),
        (dict(springs=[[0, 1]], constants=[1.0], mesh=5), "mesh"),
    ],
)
def test_wrong_arrays_are_named(given, key):
    with pytest.raises(sf.SpringfitError) as error:
        sf.Network(POINTS, given.pop("springs"), given.pop("constants"), **given)
    assert error.value.key == key, str(error.value)


def test_wrong_points_and_files_are_named(tmp_path):
    with pytest.raises(sf.SpringfitError, match="points"):
        sf.Network(np.zeros((3, 4)), [[0, 1]], [1.0])
    with pytest.raises(sf.SpringfitError, match=r"points\[1\]"):
        sf.Network([[0, 0], [np.nan, 0]], [[0, 1]], [1.0])
    mesh = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[1, 1, 1])
    with pytest.raises(sf.SpringfitError, match="those of the mesh"):
        sf.Network(2 * mesh.points, [[0, 1]], [1.0], mesh=mesh)
    for name, text in [("net.json", "{"), ("net.json", '{"format": "other"}'), ("net.npz", "no zip"), ("net.csv", "a,b")]:
        (tmp_path / name).write_text(text)
        with pytest.raises(sf.SpringfitError):
            sf.Network.load(tmp_path / name)
    np.savez(tmp_path / "other.npz", points=np.zeros((2, 3)))
    with pytest.raises(sf.SpringfitError, match="springs"):
        sf.Network.load(tmp_path / "other.npz")


def test_functions_are_not_pickled():
    mesh = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[1, 1, 1])
    net = sf.sampled(mesh, MATERIAL, "neo-hookean", force=lambda s, k: k * s, springs=["edge"], shapes={"count": 10})
    with pytest.raises(sf.SpringfitError, match="force"):
        pickle.dumps(net)
    assert len(net.equilibrium("zmin", {"zmax": [0, 0, 1.0]})) == len(net.points)

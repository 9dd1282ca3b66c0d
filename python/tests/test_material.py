"""Materials of each cell and of regions give the networks that they give one by one, and wrong ones are refused where they are written."""

import pickle

import numpy as np
import pytest

import springfit as sf

RANDOM = np.random.default_rng(5)


def unit(name, cells=3):
    d = sf.Element(name).dimension
    mesh = sf.Mesh.box(name, size=[1.0] * d, cells=[cells] * d)
    moved = mesh.points + 0.1 / cells * RANDOM.uniform(-1, 1, mesh.points.shape)
    return sf.Mesh(moved, mesh.cells, mesh.groups, cell_groups={"low": np.flatnonzero(mesh.centers[:, 0] < 0.5)})


def dense(matrix):
    return matrix.toarray()


@pytest.mark.parametrize("name", ["tet4", "hex8", "tri3", "quad4"])
@pytest.mark.parametrize("objective", ["exact", "frobenius", "offdiag"])
def test_moduli_by_cell_are_the_sum_of_the_cells(name, objective):
    """The stiffness of a body is the sum of those of its cells, each of its own modulus, which is linear in it."""
    mesh = unit(name, 2)
    cells = mesh.cells[name]
    young, poisson = RANDOM.uniform(1e3, 1e5, len(cells)), RANDOM.uniform(0.0, 0.45, len(cells))
    material = sf.Material(young, poisson)
    size = mesh.points.size
    wanted = {kind: np.zeros((size, size)) for kind in ("body", "network")}
    for i, nodes in enumerate(cells):
        one = sf.Mesh(mesh.points[nodes], {name: [range(len(nodes))]})
        own = sf.Material(young[i], poisson[i])
        dofs = (nodes[:, None] * mesh.dimension + np.arange(mesh.dimension)).ravel()
        wanted["body"][np.ix_(dofs, dofs)] += dense(sf.stiffness(one, own))
        wanted["network"][np.ix_(dofs, dofs)] += dense(sf.fit(one, own, objective).stiffness())
    largest = np.abs(wanted["body"]).max()
    # Sums of as many terms as cells around a point.
    assert np.abs(dense(sf.stiffness(mesh, material)) - wanted["body"]).max() < 1e-12 * largest
    assert np.abs(dense(sf.fit(mesh, material, objective).stiffness()) - wanted["network"]).max() < 1e-10 * largest


def test_moduli_by_cell_of_several_elements_are_counted_block_after_block():
    points = [[0.0, 0], [1, 0], [1, 1], [0, 1], [2, 0], [2, 1]]
    cells = {"tri3": [[1, 4, 5], [1, 5, 2]], "quad4": [[0, 1, 2, 3]]}
    mesh = sf.Mesh(points, cells)
    assert list(mesh.cells) == ["tri3", "quad4"]
    own = sf.stiffness(mesh, sf.Material(np.array([1e4, 2e4, 7e4]), 0.3))
    parts = [("tri3", [1, 4, 5], 1e4), ("tri3", [1, 5, 2], 2e4), ("quad4", [0, 1, 2, 3], 7e4)]
    total = np.zeros((12, 12))
    for name, nodes, young in parts:
        one = sf.stiffness(sf.Mesh(np.array(points)[nodes], {name: [range(len(nodes))]}), sf.Material(young, 0.3))
        dofs = (np.array(nodes)[:, None] * 2 + [0, 1]).ravel()
        total[np.ix_(dofs, dofs)] += dense(one)
    assert np.allclose(dense(own), total, rtol=0, atol=1e-9)


def test_density_by_cell_is_the_mass():
    mesh = unit("tet4")
    density = RANDOM.uniform(500, 2000, len(mesh.centers))
    corners = mesh.points[mesh.cells["tet4"]]
    volumes = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
    material = sf.Material(1e4, 0.3, density=density)
    assert np.isclose(sf.fit(mesh, material).masses.sum(), volumes @ density, rtol=1e-12)
    assert np.isclose(sf.mass(mesh, material).sum() / 3, volumes @ density, rtol=1e-12)


@pytest.mark.parametrize("fit", [sf.fit, lambda m, a: sf.sampled(m, a, "neo-hookean", springs=["edge"], shapes={"count": 20}), lambda m, a: sf.whole(m, a, "xmin")])
def test_regions_are_arrays_of_their_values(fit):
    mesh = unit("tet4", 2)
    is_low = np.zeros(len(mesh.centers), bool)
    is_low[mesh.cell_groups["low"]] = True
    regions = {"low": sf.Material("10 kPa", 0.2), None: sf.Material("50 kPa", 0.2)}
    by_cell = sf.Material(np.where(is_low, 1e4, 5e4), 0.2)
    assert np.allclose(fit(mesh, regions).constants, fit(mesh, by_cell).constants, rtol=1e-9)


def test_arrays_of_regions_are_of_the_whole_mesh():
    mesh = unit("tet4")
    is_low = np.zeros(len(mesh.centers), bool)
    is_low[mesh.cell_groups["low"]] = True
    young = RANDOM.uniform(1e4, 2e4, len(is_low))
    own = {"low": sf.Material(np.where(is_low, young, np.nan), 0.3), None: sf.Material(np.where(is_low, np.nan, young), 0.3)}
    assert np.array_equal(sf.fit(mesh, own).constants, sf.fit(mesh, sf.Material(young, 0.3)).constants)


def test_axes_by_cell_are_those_of_turned_bodies():
    """The stiffness of a body whose cells and axes are turned together is turned."""
    mesh = sf.Mesh.box("tri3", size=[1, 1], cells=[2, 2])
    law = {"young": [5e4, 1e4], "poisson": [0.3, 0.3], "shear": 4e3}
    along = sf.Material(transversely_isotropic=law, axes=[[1, 0, 0]])
    angle = 0.4
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    turned = sf.Mesh(mesh.points @ turn.T, mesh.cells)
    axes = np.tile([np.cos(angle), np.sin(angle), 0.0], (len(mesh.centers), 1))
    own = dense(sf.stiffness(turned, sf.Material(transversely_isotropic=law, axes=[axes])))
    q = np.kron(np.eye(len(mesh.points)), turn)
    wanted = q @ dense(sf.stiffness(mesh, along)) @ q.T
    assert np.abs(own - wanted).max() < 1e-12 * np.abs(wanted).max()


def test_expressions_are_values_at_the_centroids():
    mesh = unit("tet4", 2)
    text = sf.fit(mesh, sf.Material("1e4*(1 + x)", 0.3)).constants
    assert np.allclose(text, sf.fit(mesh, sf.Material(1e4 * (1 + mesh.centers[:, 0]), 0.3)).constants, rtol=1e-12)


@pytest.mark.parametrize(
    "make, key, words",
    [
        (lambda: sf.Material(1e4, 0.7), "poisson", "below 0.5"),
        (lambda: sf.Material(-1e4, 0.3), "young", "positive"),
        (lambda: sf.Material(1e4, 0.3, plane="Stress"), "plane", 'did you mean "stress"'),
        (lambda: sf.Material("10 apples", 0.3), "young", "apples"),
        (lambda: sf.Material([1e4, -1.0], 0.3), "young[1]", "-1.0"),
        (lambda: sf.Material(1e4, [0.3, 0.6]), "poisson[1]", "0.6"),
        (lambda: sf.Material(1e4, 0.3, density=[1.0, 0.0]), "density[1]", "0.0"),
        (lambda: sf.Material(np.ones((2, 2)), 0.3), "young", "shape (2, 2)"),
        (lambda: sf.Material(1e4, 0.3, area=[1.0, 2.0]), "area", "one area"),
        (lambda: sf.Material(1e4), "poisson", "nothing"),
        (lambda: sf.Material(young=1e4, cubic={"c11": 1.0, "c12": 0.0, "c44": 1.0}), "young", "isotropic"),
        (lambda: sf.Material(cubic={"c11": 1.0, "c12": 2.0, "c44": 1.0}), "cubic", "positive definite"),
        (lambda: sf.Material(cubic={"c11": 1.0, "c13": 2.0}), "cubic", "c13"),
        (lambda: sf.Material(1e4, 0.3, law=3), "law", "a value of type int"),
    ],
)
def test_wrong_values_are_refused_where_they_are_written(make, key, words):
    with pytest.raises(sf.SpringfitError) as error:
        make()
    assert error.value.key.startswith(key) and words in str(error.value), str(error.value)


@pytest.mark.parametrize(
    "material, key, words",
    [
        (sf.Material(np.full(5, 1e4), 0.3), "young", "expected an array of 48 values"),
        (sf.Material(np.full(48, np.nan), 0.3), "young", "found NaN in tet4 cell 1"),
        ({"low": sf.Material(1e4, 0.3)}, "material", "cells in none"),
        ({"lwo": sf.Material(1e4, 0.3), None: sf.Material(1e4, 0.3)}, 'material["lwo"].group', 'did you mean "low"'),
        ({"low": sf.Material(1e4, 0.3), "body": sf.Material(1e4, 0.3)}, "material", "in two"),
        ({3: sf.Material(1e4, 0.3)}, "material", "names of groups"),
        ({"low": 3}, "material", "a springfit.Material"),
        ({}, "material", "a springfit.Material"),
    ],
)
def test_materials_that_are_not_of_the_mesh_are_refused(material, key, words):
    mesh = unit("tet4", 2)
    for take in (sf.fit, sf.stiffness):
        with pytest.raises(sf.SpringfitError) as error:
            take(mesh, material)
        assert error.value.key == key and words in str(error.value), str(error.value)


def test_materials_are_values():
    own = sf.Material([1e4, 2e4], 0.3, density="1 g/cm^3")
    assert own == sf.Material(np.array([1e4, 2e4]), 0.3, density=1000.0) and hash(own) == hash(sf.Material([1e4, 2e4], 0.3, density=1000.0))
    assert own != sf.Material([1e4, 3e4], 0.3, density=1000.0) and "<2 values>" in repr(own)
    assert pickle.loads(pickle.dumps(own)) == own
    with pytest.raises(ValueError, match="read-only"):
        own.young[0] = 1.0
    given = np.array([1e4, 2e4])
    kept = sf.Material(given, 0.3)
    given[:] = 5.0
    assert kept.young.tolist() == [1e4, 2e4]


def test_orthotropic_constants_are_in_the_order_that_help_names():
    """The work of uniform strains is that of the inverse of the compliance, which is written here for itself."""
    young, (n12, n23, n13), (g12, g23, g13) = [3e4, 2e4, 1e4], (0.3, 0.25, 0.15), (9e3, 7e3, 5e3)
    assert "[ν12, ν23, ν13]" in sf.Material.__doc__ and "[G12, G23, G13]" in sf.Material.__doc__
    compliance = np.diag([1 / young[0], 1 / young[1], 1 / young[2], 1 / g23, 1 / g13, 1 / g12])
    for i, j, ratio in [(0, 1, n12), (1, 2, n23), (0, 2, n13)]:
        compliance[i, j] = compliance[j, i] = -ratio / young[i]
    mesh = unit("hex8", 1)
    material = sf.Material(orthotropic={"young": young, "poisson": [n12, n23, n13], "shear": [g12, g23, g13]})
    stiffness = dense(sf.stiffness(mesh, material))
    x = mesh.points
    modes = []
    for i, j in [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]:
        u = np.zeros_like(x)
        u[:, i] += x[:, j] / 2
        u[:, j] += x[:, i] / 2
        modes.append(u.ravel())
    modes = np.array(modes)
    found = modes @ stiffness @ modes.T
    wanted = np.linalg.inv(compliance)
    # The content of the cell is one factor of all entries.
    volume = found[0, 0] / wanted[0, 0]
    assert np.abs(found / volume - wanted).max() < 1e-9 * np.abs(wanted).max()


def test_materials_and_supports_do_not_change_with_what_they_are_made_of():
    mesh = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[1, 1, 1])
    stiffness, axes = 1e4 * np.eye(6), [np.tile([0, 0, 1.0], (6, 1))]
    along = {"young": [5e4, 1e4], "poisson": [0.3, 0.3], "shear": 4e3}
    materials = sf.Material(stiffness=stiffness), sf.Material(transversely_isotropic=along, axes=axes)
    before = [sf.stiffness(mesh, material).toarray() for material in materials]
    stiffness *= 3
    axes[0][:] = [1, 0, 0]
    along["young"][0] = 1e4
    assert all(np.array_equal(sf.stiffness(mesh, material).toarray(), own) for material, own in zip(materials, before))
    net = sf.fit(mesh, sf.Material(1e4, 0.3))
    flags = np.zeros(len(mesh.points), dtype=bool)
    flags[mesh.groups["xmin"]] = True
    statics = sf.Statics(net, flags)
    flags[:] = False
    flags[mesh.groups["zmin"]] = True
    forces = np.zeros(mesh.points.shape)
    forces[mesh.points.sum(axis=1).argmax()] = [0, 0, 1]
    assert np.allclose(statics(net.points, statics.values, forces=forces).displacement, net.solve("xmin", forces), rtol=1e-9, atol=0)
    with pytest.raises(sf.SpringfitError, match="displacement"):
        net.solve("xmin", np.zeros((3, *forces.shape)), np.zeros((2, *forces.shape)))

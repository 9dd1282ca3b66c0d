"""Meshes from arrays, files and other packages, and what is refused."""

import warnings

import numpy as np
import pytest

import springfit as sf

SOLIDS = ["tet4", "tet10", "hex8", "hex20", "hex27", "wedge6", "wedge15", "pyramid5", "pyramid13"]
PLANES = ["tri3", "tri6", "quad4", "quad8", "quad9"]


def box(name):
    d = sf.Element(name).dimension
    return sf.Mesh.box(name, size=[1.0, 0.8, 0.7][:d], cells=[3, 2, 2][:d])


def fitted(mesh, **keys):
    return sf.fit(mesh, sf.Material(young=1e4, poisson=0.3), **keys)


@pytest.mark.parametrize("name", SOLIDS + PLANES)
def test_arrays_give_the_mesh_again(name):
    mesh = box(name)
    again = sf.Mesh(mesh.points, dict(mesh.cells), mesh.groups)
    assert np.array_equal(again.points, mesh.points)
    assert all(np.array_equal(a, b) for a, b in zip(again.cells.values(), mesh.cells.values()))
    assert {k: v.tolist() for k, v in again.groups.items()} == {k: v.tolist() for k, v in mesh.groups.items()}
    assert np.array_equal(fitted(again).constants, fitted(mesh).constants)


@pytest.mark.parametrize("name", SOLIDS + PLANES)
def test_meshio_has_the_same_cells(name):
    meshio = pytest.importorskip("meshio")
    mesh, element = box(name), sf.Element(name)
    number, order = element.vtk
    kind = {v: k for k, v in sf._convert._MESHIO.items()}[number]
    nodes = np.empty_like(mesh.cells[0][1])
    nodes[:, order] = mesh.cells[0][1]
    points = np.zeros((len(mesh.points), 3))
    points[:, : mesh.dimension] = mesh.points
    if kind not in meshio._common.num_nodes_per_cell or kind not in meshio._mesh.topological_dimension:
        pytest.skip(f"meshio holds no {kind}")
    other = meshio.Mesh(points, [(kind, nodes)], point_sets={"held": np.arange(4)})
    again = sf.Mesh.from_meshio(other)
    assert np.array_equal(again.cells[0][1], mesh.cells[0][1])
    assert again.dimension == mesh.dimension and again.groups["held"].tolist() == [0, 1, 2, 3]


def test_meshio_reads_the_groups_of_gmsh(scenes):
    meshio = pytest.importorskip("meshio")
    own = sf.Mesh.read(scenes / "meshes" / "cube_tet.msh")
    other = sf.Mesh.from_meshio(meshio.read(scenes / "meshes" / "cube_tet.msh"))
    assert set(other.groups) == set(own.groups) and len(own.groups) > 1
    assert len(other.points) == len(own.points)
    for name, points in own.groups.items():
        places = {tuple(p) for p in own.points[points]}
        assert {tuple(p) for p in other.points[other.groups[name]]} == places


KINDS = {"MeshTri1": "ElementTriP1", "MeshQuad1": "ElementQuad1", "MeshTet1": "ElementTetP1", "MeshHex1": "ElementHex1"}


def jittered(skfem, kind):
    """A mesh of scikit-fem whose inner points are moved, the bases of displacements on it for an order of integration, ours, and its plane state."""
    rng = np.random.default_rng(1)
    mesh = getattr(skfem, kind)().refined(2)
    # No cell is a box; those of planes and bricks stay what they are.
    inner = mesh.interior_nodes()
    p = mesh.p.copy()
    p[:, inner] += 0.04 * rng.uniform(-1, 1, p[:, inner].shape)
    mesh = getattr(skfem, kind)(p, mesh.t)

    def basis(order):
        return skfem.Basis(mesh, skfem.ElementVector(getattr(skfem, KINDS[kind])()), intorder=order)

    return mesh, basis, sf.Mesh.from_skfem(mesh), "strain" if mesh.dim() == 2 else None


def node_by_node(basis, matrix):
    """A matrix of scikit-fem in our order of the degrees of freedom."""
    order = basis.nodal_dofs.T.ravel()
    return matrix[order][:, order]


@pytest.mark.parametrize("kind", KINDS)
def test_stiffness_equals_scikit_fem(kind):
    skfem = pytest.importorskip("skfem")
    from skfem.models.elasticity import lame_parameters, linear_elasticity

    _, basis, ours_mesh, plane = jittered(skfem, kind)
    # The same rule: two points along each direction of a brick.
    basis = basis(3)
    theirs = node_by_node(basis, linear_elasticity(*lame_parameters(1e4, 0.3)).assemble(basis))
    ours = sf.stiffness(ours_mesh, sf.Material(1e4, 0.3, plane=plane))
    assert abs(ours - theirs).max() <= 1e-12 * abs(theirs).max()


@pytest.mark.parametrize("kind", KINDS)
def test_masses_equal_scikit_fem(kind):
    skfem = pytest.importorskip("skfem")
    from skfem.helpers import dot

    mesh, basis, ours_mesh, plane = jittered(skfem, kind)
    density = 7.0
    material = sf.Material(1e4, 0.3, plane=plane, density=density)
    # Exact for the products of shape functions.
    basis = basis(6)
    theirs = node_by_node(basis, skfem.BilinearForm(lambda u, v, w: density * dot(u, v)).assemble(basis))
    ours = sf.mass(ours_mesh, material)
    assert abs(ours - theirs).max() <= 1e-12 * abs(theirs).max()
    blend = sf.mass(ours_mesh, material, share=0.3, total=5.0)
    volume = theirs.sum() / (density * mesh.dim())
    assert np.isclose(blend.sum(), 5.0 * mesh.dim())
    lumped = np.diag(sf.mass(ours_mesh, material, share=1.0).diagonal())
    assert np.allclose(blend.toarray(), (0.7 * theirs.toarray() + 0.3 * lumped) * 5.0 / (density * volume), atol=1e-14)


@pytest.mark.parametrize(
    ("key", "density", "keys"),
    [("density", None, {}), ("density", -1.0, {}), ("share", 1.0, {"share": 1.5}), ("total", 1.0, {"total": 0.0})],
)
def test_mass_faults_are_named(key, density, keys):
    mesh = sf.Mesh.box("tet4", [1.0, 1.0, 1.0], [1, 1, 1])
    with pytest.raises(sf.SpringfitError) as error:
        sf.mass(mesh, sf.Material(1e4, 0.3, density=density), **keys)
    assert error.value.key == key


def test_trimesh_is_a_membrane():
    trimesh = pytest.importorskip("trimesh")
    mesh = sf.Mesh.from_trimesh(trimesh.creation.icosphere(subdivisions=2))
    with pytest.raises(sf.SpringfitError) as error:
        fitted(mesh)
    assert error.value.key == "thickness"
    net = sf.fit(mesh, sf.Material(1e4, 0.3, thickness=1e-3))
    assert len(net.springs) > 0 and net.points.shape[1] == 3


def test_pyvista_both_ways():
    pyvista = pytest.importorskip("pyvista")
    grid = pyvista.ImageData(dimensions=(4, 3, 3)).cast_to_unstructured_grid()
    grid = grid.cast_to_unstructured_grid().triangulate()
    mesh = sf.Mesh.from_pyvista(grid)
    assert mesh.cells[0][0] == "tet4"
    lines = fitted(mesh).to_pyvista()
    assert lines.n_lines == len(fitted(mesh).springs) and "constants" in lines.cell_data


def test_points_without_a_cell_keep_numbers():
    points = [[9, 9, 9], [0, 0, 0], [1, 0, 0], [0, 1, 0], [8, 8, 8], [0, 0, 1]]
    with pytest.warns(UserWarning, match="2 of 6 points belong to no cell"):
        mesh = sf.Mesh(points, {"tet4": [[1, 2, 3, 5]]}, {"a": [0, 5]})
    assert mesh.numbers.tolist() == [1, 2, 3, 5] and mesh.groups["a"].tolist() == [3]
    assert mesh.quality["unused_points"] == 2


TET = [[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]


@pytest.mark.parametrize(
    "points, cells, groups, key",
    [
        (TET, {"tet4": [[0, 1, 2]]}, {}, "cells of tet4"),
        (TET, {"tet4": [0, 1, 2, 3]}, {}, "cells of tet4"),
        (TET, {"tet4": [[0, 1, 2, 4]]}, {}, "cells of tet4"),
        (TET, {"tet4": [[0, 1, 2, -1]]}, {}, "cells of tet4"),
        (TET, {"tet4": [[0.0, 1, 2, 3]]}, {}, "cells of tet4"),
        (TET, {"tet4": np.zeros((0, 4), int)}, {}, "cells of tet4"),
        (TET, {"tri3": [[0, 1, 2]], "tet4": [[0, 1, 2, 3]]}, {}, "cells of tet4"),
        (TET, {}, {}, "cells"),
        (TET, {"tet5": [[0, 1, 2, 3]]}, {}, "element"),
        (TET, {"tet4": [[0, 1, 2, 3]]}, {"a": [4]}, "groups.a"),
        (TET, {"tet4": [[0, 1, 2, 3]]}, {"a": [-1]}, "groups.a"),
        (TET, {"tet4": [[0, 1, 2, 3]]}, {"a": [[0]]}, "groups.a"),
        (TET, {"tet4": [[0, 1, 2, 3]]}, {"a": ["x"]}, "groups.a"),
        (np.full((4, 3), np.nan), {"tet4": [[0, 1, 2, 3]]}, {}, "points[0]"),
        (np.full((4, 3), 1e300), {"tet4": [[0, 1, 2, 3]]}, {}, "points"),
        (np.ones(12), {"tet4": [[0, 1, 2, 3]]}, {}, "points"),
        (np.ones((4, 4)), {"tet4": [[0, 1, 2, 3]]}, {}, "points"),
        (np.array(TET, dtype=complex), {"tet4": [[0, 1, 2, 3]]}, {}, "points"),
        (np.array(TET, dtype=object), {"tet4": [[0, 1, 2, 3]]}, {}, "points"),
        (np.zeros((4, 3)), {"tet4": [[0, 1, 2, 3]]}, {}, "points"),
        (TET, {"tet4": [[0, 1, 2, 2]]}, {}, "tet4 cell 1 at [0.0, 0.0, 0.0] m"),
        (TET, {"tet4": [[0, 1, 2, 3], [1, 0, 2, 3]]}, {}, "cells"),
        (TET, np.array([[0, 1, 2, 3]]), {}, "cells"),
        (TET, [[0, 1, 2, 3]], {}, "cells"),
        (TET, "tet4", {}, "cells"),
        (TET, {3: [[0, 1, 2, 3]]}, {}, "element"),
        (TET, [("tet4", [[0, 1, 2, 3]]), (sf.Element("tet4"), [[0, 1, 2, 3]])], {}, "cells of tet4"),
        (TET, {"tet4": [[0, 1, 2, 3], [0, 1]]}, {}, "cells of tet4"),
        (TET, {"tet4": np.ma.array([[0, 1, 2, 3]], mask=[[0, 0, 0, 1]])}, {}, "cells of tet4"),
        (TET, {"tet4": np.array([[0, 1, 2, 3]], "m8[s]")}, {}, "cells of tet4"),
        (np.ma.array(TET, mask=np.eye(4, 3)), {"tet4": [[0, 1, 2, 3]]}, {}, "points"),
        ([[0.0, 0, 0], [1, 0], [0, 1, 0], [0, 0, 1]], {"tet4": [[0, 1, 2, 3]]}, {}, "points"),
        (np.array(TET).astype("m8[s]"), {"tet4": [[0, 1, 2, 3]]}, {}, "points"),
        (TET, {"tet4": [[0, 1, 2, 3]]}, [0, 1], "groups"),
        (TET, {"tet4": [[0, 1, 2, 3]]}, {"a": np.ma.array([0, 1], mask=[0, 1])}, "groups.a"),
        (TET, {"tet4": [[0, 1, 2, 3]]}, {"a": np.array([0, 1], "m8[s]")}, "groups.a"),
    ],
)
def test_wrong_arrays_are_named(points, cells, groups, key):
    with pytest.raises(sf.SpringfitError) as error:
        sf.Mesh(points, cells, groups)
    assert error.value.key == key and error.value.kind in {"invalid", "io", "unsupported"}, str(error.value)


@pytest.mark.parametrize("dtype", [np.int32, np.int64, np.uint8, np.uint64])
@pytest.mark.parametrize("order", ["C", "F"])
def test_types_and_orders_of_arrays_do_not_matter(dtype, order):
    mesh = box("hex8")
    cells = np.array(mesh.cells[0][1], dtype=dtype, order=order)
    points = np.array(mesh.points, order=order)
    assert np.array_equal(fitted(sf.Mesh(points, {"hex8": cells})).constants, fitted(mesh).constants)
    single = sf.Mesh(points.astype(np.float32), {"hex8": cells})
    assert np.array_equal(single.points, points.astype(np.float32).astype(float))


def test_cells_of_one_element_are_put_together():
    triangles = [[0, 1, 2], [1, 3, 2]]
    blocks = [("tri3", triangles[:1]), ("tri3", triangles[1:]), ("tri3", [[1, 4, 3]])]
    mesh = sf.Mesh([[0.0, 0], [1, 0], [0, 1], [1, 1], [2, 0]], blocks)
    assert [(name, nodes.tolist()) for name, nodes in mesh.cells.items()] == [("tri3", [*triangles, [1, 4, 3]])]
    for cells in (mesh.cells, dict(mesh.cells), dict(mesh.cells).items()):
        assert np.array_equal(sf.Mesh(mesh.points, cells).cells[0][1], mesh.cells[0][1])


OWN = """
name = "mine3"
title = "A triangle of a user"
cell = "triangle"
coordinates = ["xi", "eta"]
source = "none"
nodes = [{ at = [0, 0], shape = "1 - xi - eta" }, { at = [1, 0], shape = "xi" }, { at = [0, 1], shape = "eta" }]
[quadrature]
rule = "simplex"
degree = 2
[[springs]]
group = "edge"
kind = "length"
nodes = [[0, 1], [1, 2], [2, 0]]
"""


def test_elements_of_users_are_known_by_name_where_they_are_given():
    own = sf.Element.parse(OWN)
    mesh = sf.Mesh([[0.0, 0], [1, 0], [0, 1]], {own: [[0, 1, 2]]})
    again = sf.Mesh(mesh.points, dict(mesh.cells), elements=[own])
    assert again.cells[0][0] == "mine3" and np.array_equal(again.cells[0][1], mesh.cells[0][1])


def sliver(**keys):
    return sf.Mesh([[0.0, 0], [1, 0], [0, 1], [0.5, 0.5 + 1e-6]], {"tri3": [[0, 1, 2], [1, 3, 2]]}, **keys)


def test_poor_cells_are_a_warning_an_error_or_left_out():
    for keys in ({}, {"below": "warn"}):
        with pytest.warns(UserWarning, match="1 cells have a quality below 0.0001, the worst .*tri3 cell 2") as found:
            sliver(**keys)
        assert found[0].filename == __file__
    with pytest.raises(sf.SpringfitError) as error:
        sliver(below="refuse")
    assert error.value.key == "quality"
    with pytest.warns(UserWarning, match="belong to no cell"):
        assert sliver(below="skip").quality["skipped"] == 1


@pytest.mark.filterwarnings("error")
def test_good_cells_are_no_warning():
    assert sliver(least=0.0).quality["poor"] == 0
    box("tet4")


def test_boxes_have_the_gate_of_other_meshes():
    flat = {"element": "tet4", "size": [1.0, 1.0, 1e-5], "cells": [1, 1, 1]}
    known = sf.Mesh.box(**flat)
    with pytest.warns(UserWarning, match="quality below 0.0001"):
        sf.Mesh.box(**flat, below="warn")
    with pytest.raises(sf.SpringfitError) as error:
        sf.Mesh.box(**flat, below="refuse")
    assert error.value.key == "quality"
    mesh = sf.Mesh.box(**flat, below="refuse", least=1e-6)
    assert np.array_equal(mesh.points, known.points)
    assert {k: v.tolist() for k, v in mesh.groups.items()} == {k: v.tolist() for k, v in known.groups.items()}


def test_boxes_take_arrays():
    mesh = sf.Mesh.box("quad4", np.array([1.0, 1.0]), np.array([2, 2]), np.array([0.5, 0.5]))
    assert mesh.points.min() == 0.5 and len(mesh.cells[0][1]) == 4


@pytest.mark.parametrize(
    "size, cells, keys, key",
    [
        (1.0, [1, 1], {}, "size"),
        ([1.0, 1.0], 3, {}, "cells"),
        ([1.0, "1"], [1, 1], {}, "size"),
        ([1.0, 1.0], [1.0, 1.0], {}, "cells"),
        ([1.0, 1.0], [1, -1], {}, "cells"),
        ([1.0, 1.0], [1, 1], {"origin": 0.0}, "origin"),
        ([1.0, 1.0], [1, 1], {"below": 1}, "below"),
        ([1.0, 1.0], [1, 1], {"least": "0.1"}, "least"),
        ([1.0, 1.0], [1, 1], {"least": 2.0}, "least"),
    ],
)
def test_wrong_boxes_are_named(size, cells, keys, key):
    with pytest.raises(sf.SpringfitError) as error:
        sf.Mesh.box("quad4", size, cells, **keys)
    assert error.value.key == key, str(error.value)


@pytest.mark.parametrize(
    "keys, key",
    [
        ({"scale": "2 kg"}, "scale"),
        ({"scale": -1}, "scale"),
        ({"elements": "tri3"}, "elements"),
        ({"elements": [3]}, "element"),
        ({"below": "drop"}, "below"),
    ],
)
def test_wrong_readings_are_named(scenes, keys, key):
    with pytest.raises(sf.SpringfitError) as error:
        sf.Mesh.read(scenes / "meshes" / "cube_tet.msh", **keys)
    assert error.value.key == key and len(str(error.value)) < 200, str(error.value)


def moved(name, seed=1):
    """A box whose inner points are moved, so that nothing is right by symmetry."""
    mesh = box(name)
    random = np.random.default_rng(seed)
    inside = np.ones(len(mesh.points), bool)
    for key, own in mesh.groups.items():
        if key != "body":
            inside[own] = False
    points = mesh.points + 0.05 * inside[:, None] * random.uniform(-1, 1, mesh.points.shape)
    return sf.Mesh(points, mesh.cells, mesh.groups)


@pytest.mark.parametrize("name", ["tet4", "hex8", "tri3", "quad4"])
def test_boundaries_are_those_of_scikit_fem(name):
    skfem = pytest.importorskip("skfem")
    mesh = moved(name)
    kind = {"tet4": skfem.MeshTet, "hex8": skfem.MeshHex, "tri3": skfem.MeshTri, "quad4": skfem.MeshQuad}[name]
    cells = mesh.cells[name]
    # scikit-fem's corners in VTK's order, as from_skfem has them.
    order = np.argsort([0, 3, 6, 2, 1, 5, 7, 4]) if name == "hex8" else np.arange(cells.shape[1])
    other = kind(np.ascontiguousarray(mesh.points.T), np.ascontiguousarray(cells[:, order].T))
    surface = mesh.boundary()
    wanted = {tuple(sorted(facet)) for facet in other.facets[:, other.boundary_facets()].T.tolist()}
    own = {tuple(sorted(surface.numbers[nodes].tolist())) for cells in surface.cells.values() for nodes in cells}
    assert own == wanted and len(surface.parents) == len(wanted)


@pytest.mark.parametrize("name", SOLIDS + ["tri3", "quad4", "tri6", "quad8"])
def test_normals_point_out_of_the_body(name):
    """The divergence theorem for x of bodies with plane sides: the sum of area times normal is zero, and of area times x · n is d times the volume."""
    mesh = box(name)
    surface = mesh.boundary()
    behind = mesh.centers[surface.parents]
    assert (((surface.centers - behind) * surface.normals).sum(axis=1) > 0).all()
    assert np.allclose(np.linalg.norm(surface.normals, axis=1), 1)
    sides = np.concatenate([[sf.Mesh(surface.points[nodes], {kind: [range(len(nodes))]}).volume for nodes in cells] for kind, cells in surface.cells.items()])
    assert np.abs((sides[:, None] * surface.normals).sum(axis=0)).max() < 1e-12
    assert np.isclose((sides * (surface.centers * surface.normals).sum(axis=1)).sum(), mesh.dimension * mesh.volume, rtol=1e-12)


@pytest.mark.parametrize("name", SOLIDS + PLANES)
def test_pyvista_has_the_volumes(name):
    pyvista = pytest.importorskip("pyvista")
    mesh = box(name)
    u = 0.1 * mesh.points
    grid = mesh.to_pyvista(u)
    assert grid.n_cells == len(mesh.centers) and np.array_equal(grid.point_data["u"][:, : mesh.dimension], u)
    again = sf.Mesh.from_pyvista(grid)
    assert list(again.cells) == list(mesh.cells) and all(np.array_equal(again.cells[key], mesh.cells[key]) for key in mesh.cells)
    if name in ("tet4", "hex8", "wedge6", "pyramid5", "tri3", "quad4"):
        sizes = grid.compute_cell_sizes()
        assert np.isclose(sizes["Volume" if mesh.dimension == 3 else "Area"].sum(), mesh.volume, rtol=1e-6)
    with pytest.raises(sf.SpringfitError) as error:
        mesh.to_pyvista(u[1:])
    assert error.value.key == "u"


@pytest.mark.parametrize("name", ["tet4", "tet10", "hex8", "hex20", "wedge6", "tri3", "quad4"])
def test_meshio_gives_meshes_and_groups_back(name, tmp_path):
    pytest.importorskip("meshio")
    mesh = box(name)
    mesh = sf.Mesh(mesh.points, mesh.cells, mesh.groups, cell_groups={"some": [0, 2]})
    again = sf.Mesh.from_meshio(mesh.to_meshio())
    assert np.array_equal(again.points, mesh.points) and np.array_equal(again.cells[name], mesh.cells[name])
    assert {k: v.tolist() for k, v in again.cell_groups.items()} == {k: v.tolist() for k, v in mesh.cell_groups.items()}
    mesh.save(tmp_path / "own.inp")
    read = sf.Mesh.read(tmp_path / "own.inp")
    assert np.array_equal(read.points, mesh.points) and len(read.centers) == len(mesh.centers)
    # Cells of a file come by their groups.
    assert np.allclose(read.centers[read.cell_groups["some"]], mesh.centers[[0, 2]])
    assert {k: v.tolist() for k, v in read.groups.items() if k != "some"} == {k: v.tolist() for k, v in mesh.groups.items() if k != "some"}
    assert np.isclose(sf.stiffness(read, sf.Material(1e4, 0.3)).sum(), sf.stiffness(mesh, sf.Material(1e4, 0.3)).sum(), atol=1e-6)
    with pytest.warns(UserWarning, match="have no groups"):
        mesh.save(tmp_path / "own.vtu")
    assert np.allclose(sf.Mesh.read(tmp_path / "own.vtu").points, mesh.points)
    with pytest.raises(sf.SpringfitError) as error:
        mesh.save(tmp_path / "own.docx")
    assert error.value.key == "path" and ".vtu" in str(error.value)


@pytest.mark.parametrize("name", ["tet4", "hex8", "wedge6", "tri3", "quad4"])
def test_refined_meshes_are_the_same_body(name):
    mesh = moved(name) if name != "wedge6" else box(name)
    mesh = sf.Mesh(mesh.points, mesh.cells, mesh.groups, cell_groups={"some": [0, 2]})
    fine = mesh.refine(2)
    factor = 4**mesh.dimension
    assert len(fine.centers) == factor * len(mesh.centers) and len(fine.cell_groups["some"]) == 2 * factor
    assert np.isclose(fine.volume, mesh.volume, rtol=1e-9) and np.allclose(np.ptp(fine.points[fine.groups["xmin"]][:, 0]), 0)


def test_surfaces_are_filled_whatever_holds_them(tmp_path):
    trimesh, pyvista = pytest.importorskip("trimesh"), pytest.importorskip("pyvista")
    ball = trimesh.creation.icosphere(subdivisions=3)
    ball.export(tmp_path / "ball.stl")
    known = sf.Mesh.fill(tmp_path / "ball.stl", cell=0.25, element="tet4", boundary="smooth", scale=0.01)
    assert known.volume == pytest.approx(1e-6 * ball.volume, rel=0.02)
    surface = sf.Mesh(ball.vertices, {"tri3": ball.faces})
    for own in (ball, surface, pyvista.wrap(ball), (ball.vertices, ball.faces)):
        assert sf.Mesh.fill(own, cell=0.25, element="tet4", boundary="smooth", scale=0.01).volume == pytest.approx(known.volume, rel=1e-6)
    box_of_body = sf.Mesh.fill(sf.Mesh.box("hex8", size=[1, 1, 1], cells=[2, 2, 2]).boundary(), cell=0.25)
    assert box_of_body.volume == pytest.approx(1.0) and list(box_of_body.cells) == ["hex8"]
    for keys, key in [({}, "cell"), ({"cell": -1.0}, "cell"), ({"cell": 0.2, "points": 100}, "points"), ({"cell": 0.2, "boundary": "round"}, "boundary"), ({"cell": 0.2, "repair": 1}, "repair")]:
        with pytest.raises(sf.SpringfitError) as error:
            sf.Mesh.fill(ball, **keys)
        assert error.value.key == key and error.value.file is None, str(error.value)
    with pytest.raises(sf.SpringfitError) as error:
        sf.Mesh.fill((ball.vertices, ball.faces[1:]), cell=0.2)
    assert error.value.file is None


def test_voxels_are_those_of_images():
    pyvista = pytest.importorskip("pyvista")
    labels = np.zeros((4, 3, 2), int)
    labels[1:, :, :], labels[2, 1, :] = 1, 7
    mesh = sf.Mesh.voxels(labels, spacing=[0.1, 0.2, 0.3], origin=[1, 2, 3])
    image = pyvista.ImageData(dimensions=np.array(labels.shape) + 1, spacing=(0.1, 0.2, 0.3), origin=(1, 2, 3))
    kept = image.extract_cells(np.flatnonzero(labels.ravel(order="F")))
    assert len(mesh.centers) == kept.n_cells == 18 and np.isclose(mesh.volume, 18 * 0.006)
    order = lambda centers: centers[np.lexsort(np.round(centers, 9).T)]
    assert np.allclose(order(mesh.centers), order(np.asarray(kept.cell_centers().points)), atol=1e-6)
    places = np.argwhere(labels == 7)
    assert np.allclose(order(mesh.centers[mesh.cell_groups["label=7"]]), order([1, 2, 3] + (places + 0.5) * [0.1, 0.2, 0.3]))
    parts = sf.Mesh.voxels(labels == 7, element="tet4")
    assert len(parts.centers) == 12 and np.isclose(parts.volume, 2)
    assert sf.Mesh.voxels(labels[:, :, 0], spacing=0.5).volume == pytest.approx(9 * 0.25)
    for keys, key in [({"spacing": [1, 1]}, "spacing"), ({"spacing": -1.0}, "spacing"), ({"labels": {"a": 5}}, "labels.a"), ({"labels": [1]}, "labels"), ({"element": "tri3"}, "element")]:
        with pytest.raises(sf.SpringfitError) as error:
            sf.Mesh.voxels(labels, **keys)
        assert error.value.key == key, str(error.value)
    for wrong in (labels * 0, labels * 1.5, labels[0, 0]):
        with pytest.raises(sf.SpringfitError) as error:
            sf.Mesh.voxels(wrong)
        assert error.value.key == "array"


@pytest.mark.parametrize(
    "make, words",
    [
        (lambda m: sf.Mesh(m.points, {"tetra": m.cells["tet4"]}), 'did you mean "tet4"'),
        (lambda m: sf.Mesh(m.points, {"tet4": m.cells["tet4"] + 1}), "numbered from 1"),
        (lambda m: sf.Mesh(m.points.T, m.cells), "transposed"),
        (lambda m: sf.Mesh(m.points, {"tet4": np.zeros((0, 4), int)}), "one or more cells of 4 nodes, found none"),
        (lambda m: sf.Mesh(m.points, m.cells, cell_groups={"a": [len(m.centers)]}), "cell_groups.a"),
        (lambda m: m.refine(0), "n: expected"),
        (lambda m: m.normals, "one dimension less"),
    ],
)
def test_common_mistakes_are_hinted(make, words):
    with pytest.raises(sf.SpringfitError) as error:
        make(box("tet4"))
    assert words in str(error.value), str(error.value)


def test_cells_are_a_mapping():
    mesh = box("tet4")
    assert list(mesh.cells) == ["tet4"] and dict(mesh.cells)["tet4"] is mesh.cells["tet4"] and mesh.cells[0][0] == "tet4"
    with pytest.raises(KeyError, match="did you mean"):
        mesh.cells["tetra"]
    assert list(mesh.cells_dict) == ["tet4"] and mesh.points is mesh.points
    with pytest.raises(ValueError, match="read-only"):
        mesh.points[0] = 0


@pytest.mark.parametrize("read", [sf.Mesh.read, sf.run, sf.Element])
def test_missing_files_are_errors_of_the_system(read, tmp_path):
    path = tmp_path / "nothing.toml"
    for kind in (FileNotFoundError, OSError, sf.SpringfitError, ValueError):
        with pytest.raises(kind) as error:
            read(path)
        assert str(path) in str(error.value) and error.value.kind == "io" and error.value.errno == 2
    again = __import__("pickle").loads(__import__("pickle").dumps(error.value))
    assert type(again) is type(error.value) and str(again) == str(error.value)


def test_boxes_have_their_worst_quality():
    assert box("tet4").quality["worst"] == pytest.approx(sf.Mesh(box("tet4").points, box("tet4").cells).quality["worst"])


def test_lengths_with_units_are_taken_as_in_scenes(tmp_path):
    points = np.array([[0, 0, 0], [20, 0, 0], [20, 20, 0], [0, 20, 0], [0, 0, 20], [20, 0, 20], [20, 20, 20], [0, 20, 20]], dtype=float)
    sides = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    triangles = np.array([corner for a, b, c, d in sides for corner in ((a, b, c), (a, c, d))])
    plain = sf.Mesh.fill((points, triangles), cell=4, scale=0.001)
    words = sf.Mesh.fill((points, triangles), cell="4 mm", scale="mm")
    assert np.array_equal(plain.points, words.points) and plain.volume == words.volume
    assert np.array_equal(sf.Mesh.fill((points, triangles), cell="4", scale="mm").points, plain.points)
    with pytest.raises(sf.SpringfitError, match="^cell: expected a length"):
        sf.Mesh.fill((points, triangles), cell="4 kPa", scale="mm")
    with pytest.raises(sf.SpringfitError, match="^scale: expected the length of one mesh unit"):
        sf.Mesh.fill((points, triangles), cell=4, scale="inches")


def test_cells_of_files_keep_their_order(tmp_path):
    meshio = pytest.importorskip("meshio", reason="not run: meshio is not installed; .ci/python runs this")
    box = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[2, 2, 2])
    cells = box.cells["tet4"]
    marks = np.random.default_rng(0).integers(1, 4, len(cells))
    path = tmp_path / "marked.vtu"
    meshio.write(path, meshio.Mesh(np.array(box.points), [("tetra", np.array(cells))], cell_data={"part": [marks]}))
    read = sf.Mesh.read(path)
    assert np.array_equal(read.cells["tet4"], cells)
    assert all(np.array_equal(places, np.flatnonzero(marks == int(name.split("=")[1]))) for name, places in read.cell_groups.items())


def test_middle_nodes_in_another_order_are_warned_of():
    box = sf.Mesh.box("tri6", size=[1, 1], cells=[3, 3])
    cells = np.array(box.cells["tri6"])
    with pytest.warns(UserWarning, match="another order"):
        sf.Mesh(np.array(box.points), {"tri6": cells[:, [0, 1, 2, 4, 5, 3]]})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sf.Mesh(np.array(box.points), {"tri6": cells})


def test_what_a_format_does_not_keep_is_refused(tmp_path):
    pytest.importorskip("meshio", reason="not run: meshio is not installed; .ci/python runs this")
    box = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[1, 1, 1])
    for ending in ("stl", "ply", "off"):
        path = tmp_path / f"cells.{ending}"
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with pytest.raises(sf.SpringfitError, match="path"):
                box.save(path)
        assert not path.exists()
    twice = sf.Mesh(np.array(box.points), box.cells, {"A": [0, 1], "a": [2]})
    with pytest.raises(sf.SpringfitError, match="capital"):
        twice.save(tmp_path / "groups.inp")
    for element in ("wedge15", "pyramid13"):
        with pytest.raises(sf.SpringfitError, match=element):
            sf.Mesh.box(element, size=[1, 1, 1], cells=[1, 1, 1]).to_meshio()

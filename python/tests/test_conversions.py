"""Meshes of other packages, and networks for them: the same body, its groups and its length, and nothing is dropped or read as something else."""

import numpy as np
import pytest

import springfit as sf
from conftest import raised

MATERIAL = sf.Material(young=1e4, poisson=0.3)
TWO_TRIANGLES = ([[0.0, 0], [1, 0], [0, 1], [1, 1]], [[0, 1, 2], [1, 3, 2]])


def of_meshio(cells=TWO_TRIANGLES[1], **keys):
    meshio = pytest.importorskip("meshio")
    return sf.Mesh.from_meshio(meshio.Mesh(TWO_TRIANGLES[0], [("triangle", np.array(cells))], **keys))


def test_point_sets_may_be_places_or_flags():
    flags = np.array([True, False, False, True])
    mesh = of_meshio(point_sets={"flags": flags, "places": np.flatnonzero(flags), "none": []})
    assert {k: v.tolist() for k, v in mesh.groups.items()} == {"flags": [0, 3], "places": [0, 3], "none": []}


def test_numbers_with_fractions_are_no_places():
    raised(lambda: of_meshio(np.array(TWO_TRIANGLES[1]) + 0.7), "cells of triangle")
    raised(lambda: of_meshio(point_sets={"a": np.array([0.7, 1.9])}), "point_sets.a")
    raised(lambda: of_meshio(point_sets={"a": [4]}), "point_sets.a")


def test_cell_sets_are_groups_of_the_nodes_of_their_cells():
    sets = {"first": [np.array([0])], "flagged": [np.array([False, True])], "both": [np.array([0])]}
    mesh = of_meshio(cell_sets=sets, point_sets={"both": [3]})
    assert {k: v.tolist() for k, v in mesh.groups.items()} == {"first": [0, 1, 2], "flagged": [1, 2, 3], "both": [0, 1, 2, 3]}


def test_sets_of_abaqus_are_those_of_our_reader(tmp_path):
    meshio = pytest.importorskip("meshio")
    path = tmp_path / "mesh.inp"
    path.write_text(
        "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 1, 1, 0\n*ELEMENT, TYPE=CPS3, ELSET=plate\n1, 1, 2, 3\n2, 2, 4, 3\n"
        "*NSET, NSET=held\n1, 3\n*ELSET, ELSET=right\n2,\n"
    )
    own, other = sf.Mesh.read(path), sf.Mesh.from_meshio(meshio.read(path))
    known = {name: own.groups[name].tolist() for name in own.groups}
    assert known == {name: other.groups[name].tolist() for name in other.groups} and {"held", "right"} <= set(known)


def converters():
    points, cells = np.array(TWO_TRIANGLES[0]), np.array(TWO_TRIANGLES[1])
    space = np.column_stack([points, np.zeros(4)])
    yield "meshio", sf.Mesh.from_meshio, lambda m: m.Mesh(points, [("triangle", cells)])
    yield "pyvista", sf.Mesh.from_pyvista, lambda m: m.PolyData.from_regular_faces(space, cells)
    yield "skfem", sf.Mesh.from_skfem, lambda m: m.MeshTri1(points.T.copy(), cells.T.copy())
    yield "trimesh", sf.Mesh.from_trimesh, lambda m: m.Trimesh(space, cells)


@pytest.mark.parametrize("package, call, body", list(converters()))
def test_scale_is_the_length_of_a_unit(package, call, body):
    body = body(pytest.importorskip(package))
    assert np.array_equal(call(body, scale=0.01).points, 0.01 * call(body).points)
    for scale in (0.0, "2 kg", float("inf")):
        raised(lambda: call(body, scale=scale), "scale")


@pytest.mark.parametrize("shape", [(4, 3, 3), (4, 3, 1)])
@pytest.mark.parametrize("kind", ["ImageData", "RectilinearGrid"])
def test_images_and_rectilinear_grids_are_boxes(kind, shape):
    pyvista = pytest.importorskip("pyvista")
    axes = [np.arange(n) * 0.5 for n in shape]
    grid = pyvista.ImageData(dimensions=shape, spacing=(0.5,) * 3) if kind == "ImageData" else pyvista.RectilinearGrid(*axes)
    mesh = sf.Mesh.from_pyvista(grid)
    d = 3 if shape[2] > 1 else 2
    name = {2: "quad4", 3: "hex8"}[d]
    size = [(n - 1) * 0.5 for n in shape][:d]
    box = sf.Mesh.box(name, size=size, cells=[n - 1 for n in shape][:d])
    assert [(n, len(c)) for n, c in mesh.cells.items()] == [(n, len(c)) for n, c in box.cells.items()] and mesh.quality["turned"] == 0
    order = lambda m: np.lexsort(m.points.T)
    ours, theirs = (sf.stiffness(m, MATERIAL).toarray().reshape(len(m.points), d, -1, d) for m in (mesh, box))
    a, b = order(mesh), order(box)
    assert np.allclose(mesh.points[a], box.points[b])
    assert np.allclose(ours[a][:, :, a], theirs[b][:, :, b], atol=1e-9 * abs(theirs).max())


def test_polygons_are_cells_of_surfaces():
    pyvista = pytest.importorskip("pyvista")
    angles = 2 * np.pi * np.arange(5) / 5
    points = [*zip(np.cos(angles), np.sin(angles), np.zeros(5)), (2, 0, 0)]
    mesh = sf.Mesh.from_pyvista(pyvista.PolyData(points, faces=[5, 0, 1, 2, 3, 4, 3, 0, 5, 1]))
    assert sorted((name, len(cells)) for name, cells in mesh.cells.items()) == [("pentagon5", 1), ("tri3", 1)]


def test_polygons_of_other_numbers_of_corners_are_named():
    pyvista = pytest.importorskip("pyvista")
    angles = 2 * np.pi * np.arange(7) / 7
    points = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(7)])
    for faces in ([7, *range(7)], [5, 0, 1, 2, 3, 4, 6, 0, 1, 2, 4, 5, 6]):
        raised(lambda: sf.Mesh.from_pyvista(pyvista.PolyData(points, faces=faces)), "cells of pentagon5")


@pytest.mark.parametrize("kind", ["MeshTri1", "MeshQuad1", "MeshTet1", "MeshHex1"])
def test_boundaries_and_subdomains_of_scikit_fem_are_groups(kind):
    skfem = pytest.importorskip("skfem")
    mesh = getattr(skfem, kind)().refined(2)
    mesh = mesh.with_boundaries({"left": lambda x: x[0] == 0.0, "low": lambda x: x[1] == 0.0})
    mesh = mesh.with_subdomains({"half": lambda x: x[0] < 0.5, "low": lambda x: x[1] < 0.5})
    groups = sf.Mesh.from_skfem(mesh).groups
    where = lambda flags: np.flatnonzero(flags).tolist()
    assert {name: places.tolist() for name, places in groups.items()} == {
        "left": where(mesh.p[0] == 0.0),
        "half": where(mesh.p[0] <= 0.5),
        # A boundary and a subdomain of one name are one group.
        "low": where(mesh.p[1] <= 0.5),
    }


@pytest.mark.parametrize("force", [None, "k*s"])
def test_all_springs_on_lengths_are_drawn(force):
    pytest.importorskip("pyvista")
    mesh = sf.Mesh.box("quad4", size=[1.0, 1.0], cells=[2, 2])
    net = sf.fit(mesh, MATERIAL, "offdiag") if force is None else sf.sampled(mesh, MATERIAL, "neo-hookean", force=force)
    lines = net.to_pyvista()
    assert lines.n_lines == len(net) == 20
    ends = lines.points[lines.lines.reshape(-1, 3)[:, 1:]]
    assert np.allclose(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1), lines.cell_data["rest"])
    assert len(lines.cell_data["constants"]) == 20


def test_springs_on_contents_are_no_lines():
    pytest.importorskip("pyvista")
    net = sf.fit(sf.Mesh([[0.0], [1.0], [2.0]], {"bar2": [[0, 1], [1, 2]]}), MATERIAL)
    assert len(net) > len(net.springs) and net.to_pyvista().n_lines == len(net.springs)

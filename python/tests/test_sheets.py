"""Sheets that bend against Morley's plate of scikit-fem."""

import numpy as np
import pytest

import springfit as sf

THICKNESS = 0.01


def squares(n, shift, seed=3):
    """The unit square as n x n squares of two triangles with alternating diagonals, inner points moved by a share of a side."""
    grid = np.stack(np.meshgrid(*[np.arange(n + 1)] * 2, indexing="xy"), axis=-1).reshape(-1, 2)
    inner = np.all((grid > 0) & (grid < n), axis=1)
    points = grid + shift * inner[:, None] * np.random.default_rng(seed).uniform(-1, 1, grid.shape)
    cells = []
    for j, i in np.ndindex(n, n):
        a, b = j * (n + 1) + i, j * (n + 1) + i + 1
        c, d = b + n + 1, a + n + 1
        cells += [[a, b, c], [a, c, d]] if (i + j) % 2 else [[a, b, d], [b, c, d]]
    return points / n, np.array(cells)


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.49])
@pytest.mark.parametrize("shift", [0.0, 0.3])
def test_directors_are_the_element_of_morley(poisson, shift):
    skfem = pytest.importorskip("skfem", reason="not run: scikit-fem is not installed; .ci/python runs this")
    from skfem.helpers import dd, ddot, trace

    points, cells = squares(5, shift)
    young = 12 * (1 - poisson**2) / THICKNESS**3  # D = 1 N m
    net = sf.run({
        "mesh": sf.Mesh(np.column_stack([points, np.zeros(len(points))]), {"tri3": cells}),
        "material": {"young": young, "poisson": poisson, "thickness": THICKNESS, "bending": "plate"},
        "fit": [{"objective": "exact"}],
        "fix": [{"where": "x < 0.3"}],
        "load": [{"where": "x > 0.9", "force": [0, 0, 1]}],
    }).networks["exact"]
    nodes, places = len(points), net.points
    stiffness = net.stiffness()

    mesh = skfem.MeshTri(points.T, np.sort(cells, axis=1).T)
    basis = skfem.Basis(mesh, skfem.ElementTriMorley())
    plate = skfem.BilinearForm(lambda u, v, _: (1 - poisson) * ddot(dd(u), dd(v)) + poisson * trace(dd(u)) * trace(dd(v))).assemble(basis)

    # Displacements [points, 3] of each of Morley's unknowns: the deflection of a point, and the slope across an edge.
    motions = np.zeros((basis.N, *places.shape))
    by_middle = {tuple(np.round(x, 9)): p for p, x in enumerate(places[:, :2]) if p >= nodes}
    for p in range(nodes):
        motions[basis.nodal_dofs[0, p], p, 2] = 1
    for facet, (a, b) in enumerate(mesh.facets.T):
        director = by_middle[tuple(np.round((points[a] + points[b]) / 2, 9))]
        edge = points[b] - points[a]
        length = np.linalg.norm(edge)
        along, across = edge / length, np.array([-edge[1], edge[0]]) / length
        # scikit-fem measures slopes along this normal; on the boundary along that which points outwards.
        outwards = across @ ((points[a] + points[b]) / 2 - points[mesh.t[:, mesh.f2t[0, facet]]].mean(axis=0))
        if mesh.f2t[1, facet] < 0 and outwards < 0:
            across = -across
        reach = places[director, 2]
        for end, sign in [(a, -1), (b, 1)]:
            motions[basis.nodal_dofs[0, end], director, 2] += 0.5
            motions[basis.nodal_dofs[0, end], director, :2] -= reach * sign * along / length
        motions[basis.facet_dofs[0, facet], director, :2] -= reach * across
    rows = motions.reshape(basis.N, -1)
    found = rows @ (stiffness @ rows.T)
    expected = plate.toarray()
    assert np.abs(found - expected).max() < 1e-12 * np.abs(expected).max()


@pytest.mark.parametrize("bending", ["none", "plate"])
def test_strains_on_edges_are_in_arrays(bending):
    """Springs on strains from their arrays alone: sums of squared distances of pairs of points."""
    points, cells = squares(4, 0.3)
    roof = np.column_stack([points[:, 0], np.sin(points[:, 1]), np.cos(points[:, 1])])
    mesh, material = sf.Mesh(roof, {"tri3": cells}), {"young": 1e4, "poisson": 0.3, "thickness": 0.05}
    if bending == "none":
        net = sf.fit(mesh, sf.Material(**material), shear="edges")
        assert len(net.springs) == 0
    else:
        net = sf.run({
            "mesh": mesh,
            "material": {**material, "bending": bending},
            "fit": [{"objective": "exact", "shear": "edges"}],
            "fix": [{"where": "x < 0.3"}],
            "load": [{"where": "x > 0.9", "force": [0, 1, 0]}],
        }).networks["exact edges"]
    edges = {tuple(sorted(edge)) for cell in cells for edge in zip(cell, np.roll(cell, 1))}
    (strains,) = [kind for kind in net.contents if kind["kind"] == "strain" and kind["points"].shape[1] == 4]
    (rim,) = [kind for kind in net.contents if kind["kind"] == "strain" and kind["points"].shape[1] == 3]
    assert len(strains["constants"]) + len(rim["constants"]) == 3 * len(edges)
    assert strains["unit"] == "N*m" and min(strains["constants"].min(), rim["constants"].min()) > 0

    rng = np.random.default_rng(4)
    x = net.points + 0.1 * rng.uniform(-1, 1, net.points.shape)
    membrane = sf.Network(net.points, [], [], contents=[strains, rim])
    energy = 0.0
    for kind in (strains, rim):
        for row, pairs, constant, rest in zip(kind["points"], kind["cells"], kind["constants"], kind["rest"]):
            c = sum(share * np.sum((x[row[b]] - x[row[a]]) ** 2) for (a, b), share in pairs)
            energy += constant * (c - rest) ** 2 / 2
    assert membrane.energy(x) == pytest.approx(energy, rel=1e-12)
    step, v = 1e-6, rng.uniform(-1, 1, x.shape)
    slope = (net.energy(x + step * v) - net.energy(x - step * v)) / (2 * step)
    assert slope == pytest.approx(-np.sum(net.forces(x) * v), rel=1e-6)

"""Networks of anyone as materials, and springs for matrices from elsewhere."""

import copy
import pickle

import numpy as np
import pytest

import springfit as sf

TETRAHEDRON = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
EDGES = np.array([[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]])


def affine(points, springs, constants, volume):
    """``Uᵀ K U/V`` in Kelvin's notation, by the definition."""
    d = points.shape[1]
    pairs = [(k, k) for k in range(d)] + [(k, l) for k in range(d) for l in range(k + 1, d)]
    stretch = []
    for k, l in pairs:
        strain = np.zeros((d, d))
        strain[k, l] = strain[l, k] = 1 if k == l else np.sqrt(0.5)
        x = points[springs[:, 1]] - points[springs[:, 0]]
        length = np.linalg.norm(x, axis=1)
        stretch.append(np.einsum("sk,kl,sl->s", x, strain, x) / length)
    stretch = np.array(stretch)
    return stretch * constants @ stretch.T / volume


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_tensor_is_the_energy_of_uniform_strains(dimension):
    random = np.random.default_rng(5)
    points = random.normal(size=(12, dimension))
    springs = np.array([[i, j] for i in range(12) for j in range(i)])
    constants = random.uniform(1, 2, len(springs))
    found = sf.measure(points, springs, constants, volumes=3.0)
    np.testing.assert_allclose(found.affine.stiffness, affine(points, springs, constants, 3.0), rtol=1e-12, atol=1e-12)
    assert found.volume == 3 and found.volume_of == "given" and found.relaxed is None and found.is_stable
    assert found.rigid == dimension * (dimension + 1) // 2 and found.tension["springs"] == 0
    # Ends in the other order, other types, arrays that are not contiguous.
    same = sf.measure(np.asfortranarray(points), springs[:, ::-1].astype(np.int32), constants[::-1][::-1], volumes=3)
    np.testing.assert_array_equal(same.affine.stiffness, found.affine.stiffness)


def test_frequencies_and_the_longest_step_are_those_of_scipy():
    linalg = pytest.importorskip("scipy.linalg")
    masses = np.array([1.0, 2.0, 3.0, 4.0])
    found = sf.measure(TETRAHEDRON, EDGES, np.full(6, 5.0), volumes="hull", masses=masses)
    stiffness = np.zeros((12, 12))
    for i, j in EDGES:
        n = TETRAHEDRON[j] - TETRAHEDRON[i]
        g = np.zeros(12)
        g[3 * i : 3 * i + 3], g[3 * j : 3 * j + 3] = -n / np.linalg.norm(n), n / np.linalg.norm(n)
        stiffness += 5.0 * np.outer(g, g)
    squares = linalg.eigh(stiffness, np.diag(np.repeat(masses, 3)), eigvals_only=True)
    np.testing.assert_allclose(found.frequencies, np.sqrt(squares[6:]) / (2 * np.pi), rtol=1e-8)
    np.testing.assert_allclose(found.longest_step, 2 / np.sqrt(squares[-1]), rtol=2e-3)
    np.testing.assert_allclose(found.volume, 1 / 6, rtol=1e-12)
    assert found.density == pytest.approx(60) and found.mass == 10
    held = sf.measure(TETRAHEDRON, EDGES, np.full(6, 5.0), volumes="hull", masses=masses, fix=[0, 1, 2])
    assert held.rigid == 0 and len(held.frequencies) == 3


def lattice(n, steps):
    axis = np.arange(n)
    grid = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), -1).reshape(-1, 3)
    place = lambda x: (x % n) @ [n * n, n, 1]  # noqa: E731
    return grid.astype(float), np.array([[place(x), place(x + step)] for step in steps for x in grid])


NEAREST = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
SECOND = [[1, 1, 0], [1, -1, 0], [1, 0, 1], [1, 0, -1], [0, 1, 1], [0, 1, -1]]


def test_born_s_lattice_by_arrays():
    points, springs = lattice(3, NEAREST + SECOND)
    constants = np.repeat([2.0, 0.7], [81, 162])
    found = sf.measure(points, springs, constants, cell=3 * np.eye(3), density=10.0)
    c = found.relaxed.stiffness
    np.testing.assert_allclose([c[0, 0], c[0, 1], c[3, 3]], [2 + 1.4, 0.7, 1.4], rtol=1e-10)
    np.testing.assert_allclose(found.relaxed.zener, 1.4 / 2.7, rtol=1e-10)
    assert found.volume == pytest.approx(27) and found.mass == pytest.approx(270) and found.rigid == 3 and found.is_stable
    # Without second neighbours shears meet no resistance, and planes slide.
    points, springs = lattice(3, NEAREST)
    found = sf.measure(points, springs, np.full(81, 2.0), cell=3 * np.eye(3))
    assert found.relaxed.young is None and found.relaxed.soft_strains == 3 and found.mechanisms > 0


def test_a_supercell_with_weak_bonds_is_relaxed_as_numpy_relaxes_it():
    random = np.random.default_rng(3)
    points, springs = lattice(3, NEAREST + SECOND)
    constants = random.uniform(0.2, 3, len(springs))
    found = sf.measure(points, springs, constants, cell=3 * np.eye(3))
    x = points[springs[:, 1]] - points[springs[:, 0]]
    x -= 3 * np.round(x / 3)
    length = np.linalg.norm(x, axis=1)
    n = x / length[:, None]
    g = np.zeros((len(springs), 81))
    for s, (i, j) in enumerate(springs):
        g[s, 3 * i : 3 * i + 3] -= n[s]
        g[s, 3 * j : 3 * j + 3] += n[s]
    strains = []
    for k, l in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]:
        e = np.zeros((3, 3))
        e[k, l] = e[l, k] = 1 if k == l else np.sqrt(0.5)
        strains.append(np.einsum("sk,kl,sl->s", n, e, x))
    e = np.array(strains).T
    stiffness, force = (g.T * constants) @ g, (g.T * constants) @ e
    expected = ((e.T * constants) @ e - force.T @ np.linalg.pinv(stiffness, rcond=1e-10) @ force) / 27
    np.testing.assert_allclose(found.relaxed.stiffness, expected, rtol=1e-9, atol=1e-9)
    assert (np.linalg.eigvalsh(found.affine.stiffness - found.relaxed.stiffness) > -1e-12).all()


def test_networks_of_fits_are_their_material():
    for element, poisson in [("tet4", 0.3), ("hex8", 0.45), ("tet10", 0.2), ("quad4", 0.3)]:
        d = sf.Element(element).dimension
        mesh = sf.Mesh.box(element, size=[1.0] * d, cells=[2] * d)
        net = sf.fit(mesh, sf.Material(young=1e4, poisson=poisson, density=1000))
        found = sf.measure(net)
        for own in (found.affine, found.relaxed):
            np.testing.assert_allclose([own.young, own.poisson, own.zener], [1e4, poisson, 1], rtol=1e-9)
            assert own.anisotropy < 1e-9
        assert found.volume_of == "cells" and found.is_stable and found.density == pytest.approx(1000)


def test_regions_and_volumes_of_points():
    # Two materials side by side: all springs below x = 2.25 are twice as stiff.
    points, springs = lattice(6, NEAREST + SECOND)
    middle = points[springs].mean(axis=1)[:, 0]
    inside = np.abs(points[springs[:, 0]] - points[springs[:, 1]]).max(axis=1) < 2
    springs, middle = springs[inside], middle[inside]
    constants = np.where(middle < 2.25, 2.0, 1.0)
    whole = sf.measure(points, springs, constants, volumes=np.ones(216), regions={"left": points[:, 0] < 2, "all": np.arange(216)})
    assert whole.volume == 216 and whole.regions["left"].points == 72 and whole.regions["left"].volume == 72
    np.testing.assert_allclose(whole.regions["all"].affine.stiffness, whole.affine.stiffness, rtol=1e-12)
    part = lambda x: sf.measure(points, springs, constants, volumes=np.ones(216), regions={"part": x}).regions["part"]  # noqa: E731
    core = lambda low: ((points > [low, 1, 1]) & (points < [low + 1.5, 4, 4])).all(axis=1)  # noqa: E731
    # Points whose springs are all of one material have its tensor.
    np.testing.assert_allclose(part(core(0.5)).affine.stiffness, 2 * part(core(3.5)).affine.stiffness, rtol=1e-12, atol=1e-12)


def test_tension_is_told():
    rest = np.array([1, 1, 1, 1.5, 1.5, 1.5])
    found = sf.measure(TETRAHEDRON, EDGES, np.full(6, 5.0), rest=rest, volumes="hull")
    assert found.tension["springs"] == 3 and found.tension["unbalanced"] > 0.1 and "not at rest" in found.notes[0]
    # A square in a frame: sides that pull, and diagonals that push.
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
    springs = np.array([[0, 1], [1, 2], [2, 3], [3, 0], [0, 2], [1, 3]])
    rest = np.array([0.9] * 4 + [np.sqrt(2) + 0.1 * np.sqrt(2)] * 2)
    # A side pulls each corner with k·0.1 along two axes; a diagonal pushes with √2 of that.
    found = sf.measure(square, springs, np.array([1.0] * 4 + [1.0] * 2), rest=rest, volumes="hull")
    assert found.tension["springs"] == 6 and found.tension["unbalanced"] < 1e-12
    np.testing.assert_allclose(found.tension["stress"], 0, atol=1e-12)


def test_an_engine_has_a_limit():
    mesh = sf.Mesh.box("tet4", size=[0.1, 0.1, 0.3], cells=[2, 2, 6])
    net = sf.fit(mesh, sf.Material(young=1e5, poisson=0.25, density=1000), objective="offdiag", nonnegative=True)
    few, many = (sf.measure(net, engine={"method": "xpbd", "substeps": n}).engine for n in (2, 50))
    assert few["ceiling"] < many["ceiling"] and few["least_substeps"] == many["least_substeps"] > 1
    assert sf.measure(net, engine="vbd").engine is None
    with pytest.raises(sf.SpringfitError, match="engine"):
        sf.measure(net, engine="nonsense")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"points": TETRAHEDRON.T[:, :2]}, "points"),
        ({"points": np.full((4, 3), np.nan)}, "points"),
        ({"springs": EDGES + 1}, "numbered from 1"),
        ({"springs": [[0, 0]], "constants": [1.0]}, "two points"),
        ({"springs": EDGES.astype(float)}, "integers"),
        ({"constants": [1.0, 2.0]}, "constants"),
        ({"constants": np.full(6, np.inf)}, "constants"),
        ({"rest": [1.0]}, "rest"),
        ({"volumes": None}, "volume"),
        ({"volumes": -1.0}, "volume"),
        ({"volumes": "sphere"}, "hull"),
        ({"volumes": [1.0, 2.0]}, "volumes"),
        ({"masses": [1.0]}, "masses"),
        ({"regions": {"a": [9]}}, "regions"),
        ({"regions": {"a": [0]}}, "regions"),
        ({"plane": "stress"}, "plane"),
        ({"cell": np.eye(3)}, "cell"),
        ({"cell": np.zeros((3, 3))}, "cell"),
        ({"contents": ([[0, 1, 2, 3]], [1.0])}, "contents"),
        ({"frequencies": -1}, "frequencies"),
        ({"density": 5.0}, "density"),
    ],
)
def test_bad_arrays_are_named(change, words):
    given = {"points": TETRAHEDRON, "springs": EDGES, "constants": np.full(6, 5.0), "volumes": "hull", **change}
    with pytest.raises(sf.SpringfitError, match=words):
        sf.measure(given.pop("points"), given.pop("springs"), given.pop("constants"), **given)


def test_files_are_measured_and_their_faults_named(tmp_path):
    logarithms = np.log(np.array([2.0, 3.0, 4.0, 5.0, 6.0, 7.0]))
    rest = np.linalg.norm(TETRAHEDRON[EDGES[:, 1]] - TETRAHEDRON[EDGES[:, 0]], axis=1)
    arrays = {
        "init_vertices": TETRAHEDRON.astype(np.float32), "init_springs": EDGES.astype(np.int32), "init_rest_lengths": rest,
        "spring_Y": logarithms, "init_masses": np.ones(4, np.float32), "num_object_points": np.int64(4),
    }
    np.savez_compressed(tmp_path / "twin.npz", **arrays)
    found = sf.measure(tmp_path / "twin.npz", volumes="hull")
    expected = sf.measure(TETRAHEDRON, EDGES, np.exp(logarithms) / rest, volumes="hull", masses=np.ones(4))
    np.testing.assert_allclose(found.affine.stiffness, expected.affine.stiffness, rtol=1e-12)
    assert found.mass == 4
    np.savez(tmp_path / "fewer.npz", **{**arrays, "spring_Y_min": 2.5, "spring_Y_max": 6.5})
    found = sf.measure(tmp_path / "fewer.npz", volumes="hull")
    constants = np.minimum(np.exp(logarithms), 6.5)[1:] / rest[1:]
    np.testing.assert_allclose(found.affine.stiffness, sf.measure(TETRAHEDRON, EDGES[1:], constants, volumes="hull").affine.stiffness)
    np.savez(tmp_path / "bare.npz", vertices=TETRAHEDRON, springs=EDGES, stiffness=np.full(6, 5.0))
    assert sf.measure(tmp_path / "bare.npz", volumes=1.0).is_stable
    np.savez(tmp_path / "none.npz", a=np.ones(3))
    with pytest.raises(sf.SpringfitError, match="points, springs and k"):
        sf.measure(tmp_path / "none.npz", volumes=1.0)
    (tmp_path / "no.npz").write_bytes(b"PK\x03\x04 cut")
    with pytest.raises(sf.SpringfitError, match="ZIP"):
        sf.measure(tmp_path / "no.npz", volumes=1.0)
    with pytest.raises(sf.SpringfitError):
        sf.measure(tmp_path / "missing.npz")
    with pytest.raises(sf.SpringfitError, match="constants"):
        sf.measure(tmp_path / "bare.npz", constants=[1.0])


def test_measurements_are_copied_and_pickled():
    found = sf.measure(TETRAHEDRON, EDGES, np.full(6, 5.0), volumes="hull")
    assert pickle.loads(pickle.dumps(found)).affine.young == copy.deepcopy(found).affine.young


def test_matrices_of_elements_and_of_superelements():
    sparse = pytest.importorskip("scipy.sparse")
    material = sf.Material(young=1e4, poisson=0.3)
    cube = sf.Mesh.box("hex8", size=[1, 1, 1], cells=[1, 1, 1])
    matrix = sf.stiffness(cube, material)
    found = sf.fit_matrix(matrix, cube.points)
    own = sf.fit(cube, material, objective="frobenius")
    order = {tuple(pair): k for pair, k in zip(own.springs.tolist(), own.constants)}
    np.testing.assert_allclose(found.constants, [order[tuple(sorted(pair))] for pair in found.springs.tolist()], rtol=1e-11)
    # A block of 3 × 3 × 3 cubes whose inner points SciPy condenses.
    block = sf.Mesh.box("hex8", size=[1, 1, 1], cells=[3, 3, 3])
    whole = sf.stiffness(block, material)
    corners = np.flatnonzero(((block.points == 0) | (block.points == 1)).all(axis=1))
    kept = corners[:, None] * 3 + np.arange(3)
    others = np.setdiff1d(np.arange(whole.shape[0]), kept.ravel())
    dense = whole.toarray()
    a, b, c = dense[np.ix_(kept.ravel(), kept.ravel())], dense[np.ix_(kept.ravel(), others)], dense[np.ix_(others, others)]
    condensed = a - b @ np.linalg.solve(c, b.T)
    by_hand = sf.fit_matrix(condensed, block.points[corners])
    by_us = sf.fit_matrix(sparse.coo_array(whole), block.points[corners], displacements=kept)
    assert by_us.condensed == len(others) and len(by_us.constants) == 28
    np.testing.assert_allclose(by_us.constants, by_hand.constants, rtol=1e-8, atol=1e-8 * np.abs(by_hand.constants).max())
    # The normal equations by NumPy.
    g = np.zeros((28, 24))
    for s, (i, j) in enumerate(by_hand.springs):
        n = block.points[corners[j]] - block.points[corners[i]]
        n /= np.linalg.norm(n)
        g[s, 3 * i : 3 * i + 3], g[s, 3 * j : 3 * j + 3] = -n, n
    constants = np.linalg.solve((g @ g.T) ** 2, np.einsum("si,ij,sj->s", g, condensed, g))
    np.testing.assert_allclose(by_hand.constants, constants, rtol=1e-9, atol=1e-9 * np.abs(constants).max())
    rest = condensed - (g.T * constants) @ g
    assert by_hand.frobenius == pytest.approx(np.linalg.norm(rest) / np.linalg.norm(condensed), rel=1e-9)
    assert by_hand.spectral == pytest.approx(np.linalg.norm(rest, 2) / np.linalg.norm(condensed, 2), rel=1e-9)
    # No other constants have a smaller 2-norm than those of the spectral objective, and none is negative where that is asked for.
    spectral = sf.fit_matrix(condensed, block.points[corners], objective="spectral")
    assert spectral.spectral < by_hand.spectral and spectral.gap < 1e-6
    assert (sf.fit_matrix(condensed, block.points[corners], nonnegative=True).constants >= 0).all()


def test_rotations_of_a_beam_are_condensed():
    # A frame of Euler–Bernoulli beams in the plane, with u, v and a rotation at each node: EA/L and 12 EI/L³ are what is known of it.
    E, A, I, L = 2.0, 3.0, 5.0, 2.0
    bar, bend = E * A / L, E * I / L**3
    beam = np.zeros((6, 6))
    beam[np.ix_([0, 3], [0, 3])] = bar * np.array([[1, -1], [-1, 1]])
    beam[np.ix_([1, 2, 4, 5], [1, 2, 4, 5])] = bend * np.array(
        [[12, 6 * L, -12, 6 * L], [6 * L, 4 * L**2, -6 * L, 2 * L**2], [-12, -6 * L, 12, -6 * L], [6 * L, 2 * L**2, -6 * L, 4 * L**2]]
    )
    points = np.array([[0.0, 0.0], [L, 0.0]])
    found = sf.fit_matrix(beam, points, displacements=[[0, 1], [3, 4]])
    # Free rotations leave the bar.
    np.testing.assert_allclose(found.constants, [bar], rtol=1e-12)
    assert found.frobenius < 1e-12 and found.condensed == 2


def test_bad_matrices_are_named(tmp_path):
    cube = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[1, 1, 1])
    matrix = sf.stiffness(cube, sf.Material(young=1e4, poisson=0.3)).toarray()
    n = len(cube.points)
    skew = matrix.copy()
    skew[0, 4] += 300
    held = matrix + np.eye(len(matrix))* 50
    cases = [
        (skew, {}, "symmetry"), (held, {}, "translation along x"), (matrix[:-1], {}, "square"), (matrix[:-3, :-3], {}, "rows"),
        (np.full_like(matrix, np.nan), {}, "finite"), (np.zeros_like(matrix), {}, "stiffness"),
        (matrix, {"springs": [[0, n]]}, "springs"), (matrix, {"springs": [[0, 0]]}, "springs"), (matrix, {"springs": np.zeros((0, 2), int)}, "springs"),
        (matrix, {"objective": "nonsense"}, "objective"), (matrix, {"displacements": [[0, 1, 2]]}, "displacements"),
        (matrix, {"objective": 3}, "objective"),
    ]
    for given, more, words in cases:
        with pytest.raises(sf.SpringfitError, match=words):
            sf.fit_matrix(given, cube.points, **more)
    scipy_io = pytest.importorskip("scipy.io")
    scipy_io.mmwrite(tmp_path / "r.mtx", matrix, precision=17)
    same = sf.fit_matrix(tmp_path / "r.mtx", cube.points)
    np.testing.assert_allclose(same.constants, sf.fit_matrix(matrix, cube.points).constants, rtol=1e-12)
    (tmp_path / "bad.mtx").write_text("%%MatrixMarket matrix coordinate real general\n2 2 1\n3 1 5\n")
    with pytest.raises(sf.SpringfitError, match="a place from 1 to 2"):
        sf.fit_matrix(tmp_path / "bad.mtx", cube.points)


def test_what_belongs_to_files_is_refused_beside_arrays():
    net = sf.fit(sf.Mesh.box("tet4", size=[1, 1, 1], cells=[1, 1, 1]), sf.Material(1e4, 0.3))
    for keys in ({"periodic": True}, {"table": "points.csv"}):
        with pytest.raises(sf.SpringfitError, match=next(iter(keys))):
            sf.measure(net, **keys)
        with pytest.raises(sf.SpringfitError, match=next(iter(keys))):
            sf.measure(net.points, net.springs, net.constants, volumes=1.0, **keys)

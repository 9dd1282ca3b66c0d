"""Derivatives of spring constants are those of differences."""

import numpy as np
import pytest

import springfit as sf

CASES = [
    ("tet4", "exact", {}),
    ("tet4", "exact", {"volume": "cells"}),
    ("tet4", "offdiag", {}),
    ("tet4", "frobenius", {}),
    ("tet4", "frobenius", {"tied": True}),
    ("hex8", "exact", {}),
    ("hex8", "offdiag", {}),
    ("hex8", "frobenius", {}),
    ("hex8", "modal", {"higher": 0.3, "springs": ["edge", "face diagonal", "body diagonal", "bulk"]}),
    ("tet10", "exact", {}),
    ("tri3", "frobenius", {}),
    ("quad4", "exact", {}),
    ("quad4", "offdiag", {}),
]


def case(name, objective, keys, plane=None):
    d = sf.Element(name).dimension
    mesh = sf.Mesh.box(name, size=[1.0, 0.8, 0.7][:d], cells=[3, 2, 2][:d])
    rng = np.random.default_rng(7)
    # A fifth of a cell, so that no symmetry hides a wrong sign.
    points = mesh.points + 0.05 * rng.uniform(-1, 1, mesh.points.shape)
    constants = sf.SpringConstants(name, mesh.cells[0][1], objective, plane=plane, **keys)
    return constants, points, mesh, rng


@pytest.mark.parametrize("name, objective, keys", CASES)
@pytest.mark.parametrize("plane", ["stress", "strain"])
def test_gradients_are_those_of_differences(name, objective, keys, plane):
    if sf.Element(name).dimension == 3:
        if plane == "strain":
            return
        plane = None
    constants, points, _, rng = case(name, objective, keys, plane)
    given = (points, 1e4, 0.3, 0.02 if plane else 1.0)
    k, other = constants(*given)
    weights, others = rng.normal(size=k.shape), rng.normal(size=other.shape) * (abs(k).max() / max(abs(other).max(initial=0), 1e-300))
    found = constants.gradient(*given, weights=weights, others=others)

    def loss(points, *moduli):
        k, other = constants(points, *moduli)
        return np.sum(weights * k) + np.sum(others * other)

    def slope(along, size):
        # Richardson's: the error of two central differences cancels to the fourth order.
        central = lambda h: (loss(*along(h)) - loss(*along(-h))) / (2 * h)
        return (4 * central(size / 2) - central(size)) / 3

    for _ in range(3):
        v = rng.normal(size=points.shape)
        known = slope(lambda h: (points + h * v, *given[1:]), 1e-4)
        assert np.sum(found.points * v) == pytest.approx(known, rel=1e-6)
    for index, own in enumerate([found.young, found.poisson, found.thickness], 1):
        if index == 3 and plane is None:
            continue
        along = lambda h: tuple(x + h if i == index else x for i, x in enumerate(given))
        assert own == pytest.approx(slope(along, 1e-3 * given[index]), rel=1e-6)


@pytest.mark.parametrize("objective", ["exact", "offdiag", "frobenius"])
@pytest.mark.parametrize("name", ["tet4", "hex8", "quad4"])
def test_constants_are_those_of_the_network(name, objective):
    constants, points, mesh, _ = case(name, objective, {})
    net = sf.fit(sf.Mesh(points, dict(mesh.cells)), sf.Material(1e4, 0.3), objective)
    k, _ = constants(points, 1e4, 0.3)
    known = {tuple(pair): constant for pair, constant in zip(net.springs.tolist(), net.constants)}
    # A network leaves out springs that cancel.
    found = np.array([known.get(tuple(pair), 0.0) for pair in constants.springs.tolist()])
    assert np.abs(k - found).max() <= 1e-12 * np.abs(k).max()
    assert len(known) <= len(k)


@pytest.mark.parametrize(
    "call, key",
    [
        (lambda: sf.SpringConstants("tet4", [[0, 1, 2]]), "cells"),
        (lambda: sf.SpringConstants("tet4", [[0, 1, 2, 3]], "spectral"), "objective"),
        (lambda: sf.SpringConstants("tet4", [[0, 1, 2, 3]], "van-gelder"), "objective"),
        (lambda: sf.SpringConstants("tet4", [[0, 1, 2, 3]], "exact", volume="patches"), "objective"),
        (lambda: sf.SpringConstants("tet4", [[0, 1, 2, 3]], "offdiag", nonnegative=True), "objective"),
        (lambda: sf.SpringConstants("tri3", [[0, 1, 2]], plane="both"), "plane"),
        (lambda: sf.SpringConstants("tri3", [[0, 1, 2]], plane=1), "plane"),
    ],
)
def test_wrong_functions_are_refused(call, key):
    with pytest.raises(sf.SpringfitError) as error:
        constants = call()
        points = np.eye(4, 3)
        constants.gradient(points, 1.0, 0.3, weights=np.ones(len(constants.springs)))
    assert error.value.key == key, str(error.value)


def test_wrong_arrays_are_refused():
    constants, points, _, _ = case("tet4", "offdiag", {})
    weights = np.ones(len(constants.springs))
    for given, options, key in [
        ((points[:, :2], 1e4, 0.3), {}, "points"),
        ((points[:5], 1e4, 0.3), {}, None),
        ((points * np.nan, 1e4, 0.3), {}, "points"),
        ((0 * points, 1e4, 0.3), {}, None),
        ((points, -1.0, 0.3), {}, "young"),
        ((points, 1e4, 0.6), {}, "poisson"),
        ((points, 1e4, 0.3), {"weights": weights[1:]}, "weights"),
        ((points, 1e4, 0.3), {"weights": np.ma.array(weights, mask=weights > 0)}, "weights"),
        ((points, 1e4, 0.3), {"weights": weights.astype("m8[s]")}, "weights"),
        ((points, 1e4, 0.3), {"weights": [[1.0], [1.0, 2.0]]}, "weights"),
        ((np.ma.array(points, mask=points > 0), 1e4, 0.3), {}, "points"),
        ((points, "10 kPa", 0.3), {}, "young"),
        ((points, 1e4, [0.3]), {}, "poisson"),
        ((points, 1e4, 0.3), {"others": [[1.0]]}, "others"),
    ]:
        with pytest.raises(sf.SpringfitError) as error:
            constants.gradient(*given, **{"weights": weights, **options})
        assert key is None or key in str(error.value.key), str(error.value)


def test_constants_keep_their_cells():
    mesh = sf.Mesh.box("tet4", size=[1.0, 1.0, 1.0], cells=[2, 1, 1])
    cells = mesh.cells[0][1].copy()
    constants = sf.SpringConstants("tet4", cells)
    known = constants(mesh.points, 1e4, 0.3)
    cells[:] = cells[0]
    for array in (constants.springs, constants.cells):
        with pytest.raises(ValueError, match="read-only"):
            array[:] = 0
    again = constants(mesh.points, 1e4, 0.3)
    assert all(np.array_equal(a, b) for a, b in zip(known, again))


@pytest.mark.parametrize(
    "objective, keys",
    [("spectral", {}), ("divergence", {}), ("frobenius", {"weight": "relative"}), ("frobenius", {"nonnegative": True})],
)
def test_constants_without_gradients_are_those_of_the_network(objective, keys):
    constants, points, mesh, _ = case("tet4", objective, keys)
    net = sf.fit(sf.Mesh(points, mesh.cells), sf.Material(1e4, 0.3), objective, **keys)
    known = {tuple(pair): constant for pair, constant in zip(net.springs.tolist(), net.constants)}
    k, _ = constants(points, 1e4, 0.3)
    found = np.array([known.get(tuple(pair), 0.0) for pair in constants.springs.tolist()])
    assert np.abs(k - found).max() <= 1e-9 * np.abs(k).max()
    with pytest.raises(sf.SpringfitError) as error:
        constants.gradient(points, 1e4, 0.3, weights=np.ones_like(k))
    assert error.value.key == "objective"


def test_torch_passes_gradients_on():
    torch = pytest.importorskip("torch", reason="not run: torch is not installed; .ci/petsc runs this with Debian's")
    constants, points, _, rng = case("tet4", "exact", {})
    x = torch.tensor(points, requires_grad=True)
    young, poisson = torch.tensor(1e4, dtype=torch.float64, requires_grad=True), torch.tensor(0.3, dtype=torch.float64, requires_grad=True)
    k, other = constants.torch(x, young, poisson)
    (k.square().sum() + other.square().sum()).backward()
    known = constants.gradient(points, 1e4, 0.3, weights=2 * k.detach().numpy(), others=2 * other.detach().numpy())
    assert np.allclose(x.grad.numpy(), known.points, rtol=1e-12)
    assert young.grad.item() == pytest.approx(known.young) and poisson.grad.item() == pytest.approx(known.poisson)
    assert torch.autograd.gradcheck(lambda x: constants.torch(x, 1.0, 0.3)[0], torch.tensor(points, requires_grad=True), atol=1e-6)


def test_jax_passes_gradients_on():
    jax = pytest.importorskip("jax", reason="not run: jax is not installed; .ci/python runs this")
    jax.config.update("jax_enable_x64", True)
    constants, points, _, _ = case("tet4", "exact", {})

    @jax.jit
    def loss(x, young, poisson):
        k, other = constants.jax(x, young, poisson)
        return (k**2).sum() + (other**2).sum()

    slopes = jax.grad(loss, (0, 1, 2))(points, 1e4, 0.3)
    k, other = constants(points, 1e4, 0.3)
    known = constants.gradient(points, 1e4, 0.3, weights=2 * k, others=2 * other)
    assert np.allclose(slopes[0], known.points, rtol=1e-12)
    assert float(slopes[1]) == pytest.approx(known.young) and float(slopes[2]) == pytest.approx(known.poisson)


def test_jax_maps_over_bodies():
    jax = pytest.importorskip("jax", reason="not run: jax is not installed; .ci/python runs this")
    jax.config.update("jax_enable_x64", True)
    constants, points, _, rng = case("tet4", "exact", {})
    many = points + 0.01 * rng.uniform(-1, 1, (3, *points.shape))
    moduli = np.array([1e3, 1e4, 1e5])

    def loss(x, young):
        k, other = constants.jax(x, young, 0.3)
        return (k**2).sum() + (other**2).sum()

    values = jax.vmap(loss)(many, moduli)
    slopes = jax.jit(jax.vmap(jax.grad(loss, (0, 1))))(many, moduli)
    for i, (x, young) in enumerate(zip(many, moduli)):
        assert float(values[i]) == pytest.approx(float(loss(x, young)))
        own = jax.grad(loss, (0, 1))(x, young)
        assert np.allclose(slopes[0][i], own[0], rtol=1e-12) and float(slopes[1][i]) == pytest.approx(float(own[1]))
    # The same points with many materials.
    shared = jax.vmap(loss, (None, 0))(points, moduli)
    assert np.allclose(shared, [float(loss(points, young)) for young in moduli])


def test_springs_that_vanish_at_right_angles_have_gradients():
    mesh = sf.Mesh.box("tet4", size=[1.0, 1.0, 1.0], cells=[2, 2, 2])
    constants = sf.SpringConstants("tet4", mesh.cells[0][1], "exact")
    k, _ = constants(mesh.points, 1.0, 0.3)
    gone = k == 0.0
    assert gone.any()
    weights = gone.astype(float) * np.random.default_rng(8).normal(size=k.shape)
    found = constants.gradient(mesh.points, 1.0, 0.3, weights=weights).points
    v = np.random.default_rng(9).normal(size=found.shape)
    along = lambda h: weights @ constants(mesh.points + h * v, 1.0, 0.3)[0]
    central = lambda h: (along(h) - along(-h)) / (2 * h)
    known = (4 * central(5e-5) - central(1e-4)) / 3
    assert abs(known) > 1e-3 and np.sum(found * v) == pytest.approx(known, rel=1e-6)

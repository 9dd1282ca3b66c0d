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
    ("hex8", "exact", {"volume": "cells"}),
    ("hex8", "offdiag", {}),
    ("hex8", "offdiag", {"springs": ["edge", "face diagonal", "body diagonal", "bulk"]}),
    ("hex8", "frobenius", {}),
    ("hex8", "frobenius", {"springs": ["edge", "face diagonal", "body diagonal", "bulk"]}),
    ("hex8", "modal", {}),
    ("hex8", "modal", {"higher": 0.3, "springs": ["edge", "face diagonal", "body diagonal", "bulk"]}),
    ("tet10", "exact", {}),
    ("tet10", "frobenius", {}),
    ("tri3", "frobenius", {}),
    ("quad4", "exact", {}),
    ("quad4", "offdiag", {}),
    ("quad4", "modal", {}),
]


def case(name, objective, keys, plane=None):
    d = sf.Element(name).dimension
    mesh = sf.Mesh.box(name, size=[1.0, 0.8, 0.7][:d], cells=[3, 2, 2][:d])
    rng = np.random.default_rng(7)
    # A fifth of a cell, so that no symmetry hides a wrong sign; less where nodes are at the middle of edges.
    size = 0.05 if mesh.cells[0][1].shape[1] <= 8 else 0.01
    points = mesh.points + size * rng.uniform(-1, 1, mesh.points.shape)
    constants = sf.SpringConstants(mesh.cells, objective, plane=plane, **keys)
    return constants, points, mesh, rng


def states(name):
    return ["stress", "strain"] if sf.Element(name).dimension == 2 else [None]


BODIES = [(*own, plane) for own in CASES for plane in states(own[0])]


def slope(function, size):
    """The derivative at zero. Richardson's: the errors of two central differences cancel to the fourth order."""
    central = lambda h: (function(h) - function(-h)) / (2 * h)
    return (4 * central(size / 2) - central(size)) / 3


def weighted(rng, values):
    """Weights by which each kind of value counts as much as another."""
    return [rng.normal(size=own.shape) / max(np.abs(own).max(initial=0), 1e-300) for own in values]


@pytest.mark.parametrize("name, objective, keys, plane", BODIES)
def test_gradients_are_those_of_differences(name, objective, keys, plane):
    constants, points, mesh, rng = case(name, objective, keys, plane)
    count = sum(len(cells) for _, cells in mesh.cells.items())
    fields = (1e4 * rng.uniform(0.5, 2, count), rng.uniform(0.1, 0.4, count), rng.uniform(0.01, 0.03, count) if plane else 1.0)
    for given in [(points, 1e4, 0.3, 0.02 if plane else 1.0), (points, *fields)]:
        weights = weighted(rng, constants(*given))
        found = constants.gradient(*given, **dict(zip(["weights", "contents", "rest", "rest_contents"], weights)))
        loss = lambda *given: sum(np.sum(w * own) for w, own in zip(weights, constants(*given)))
        for index, own in enumerate([found.points, found.young, found.poisson, found.thickness]):
            if index == 3 and plane is None:
                assert np.all(own == 0)
                continue
            value = given[index]
            assert np.shape(own) == np.shape(value)
            v = np.asarray(rng.normal(size=np.shape(value))) * (value if index else 1.0)
            moved = lambda h: tuple(x + h * v if i == index else x for i, x in enumerate(given))
            # Differences of these steps have eight digits of the largest part.
            known, step = slope(lambda h: loss(*moved(h)), 1e-3 if index else 3e-4), np.sum(np.abs(own * v))
            assert np.sum(own * v) == pytest.approx(known, abs=1e-8 * step, rel=1e-8)


@pytest.mark.parametrize("name, objective, keys, plane", BODIES)
def test_products_in_both_directions_are_transposes(name, objective, keys, plane):
    constants, points, mesh, rng = case(name, objective, keys, plane)
    count = sum(len(cells) for _, cells in mesh.cells.items())
    given = (points, 1e4 * rng.uniform(0.5, 2, count), rng.uniform(0.1, 0.4, count), 0.02 if plane else 1.0)
    w = weighted(rng, constants(*given))
    change = [rng.normal(size=np.shape(own)) * scale for own, scale in zip(given, (1.0, 1e4, 0.1, 0.01 if plane else 0.0))]
    moved = constants.along(*given, changes=tuple(change))
    found = constants.gradient(*given, **dict(zip(["weights", "contents", "rest", "rest_contents"], w)))
    slopes = [found.points, found.young, found.poisson, found.thickness]
    parts = [own * change for own, change in zip(slopes, change)]
    # The kernels of the fits on dual numbers, beside the lines of the gradient: both are exact.
    size = 1e-12 * sum(np.sum(np.abs(part)) for part in parts)
    assert sum(np.sum(w * own) for w, own in zip(w, moved)) == pytest.approx(sum(map(np.sum, parts)), abs=size)


@pytest.mark.parametrize("objective", ["exact", "frobenius"])
def test_slivers_do_not_depend_on_the_cells_beside_them(objective):
    mesh = sf.Mesh.box("tet4", size=[1.0, 1.0, 1.0], cells=[3, 3, 3])
    rng = np.random.default_rng(8)
    points = mesh.points + 0.05 * rng.uniform(-1, 1, mesh.points.shape)
    # The cells of the first layer are too flat for vector lanes, which leave them to numbers one by one.
    points[:, 2] = np.where(mesh.points[:, 2] < 0.5, 3e-4 * points[:, 2], points[:, 2] - 0.3)
    cells = mesh.cells[0][1]
    constants = sf.SpringConstants({"tet4": cells}, objective)
    change = (rng.normal(size=points.shape), rng.normal(size=len(cells)), np.zeros(len(cells)))
    young = rng.uniform(1, 2, len(cells))
    moved = constants.along(points, young, 0.3, changes=(*change[:2], None))
    assert all(np.all(np.isfinite(own)) for own in moved)
    # A weight of the springs of single cells.
    for cell in range(0, len(cells), 7):
        alone = sf.SpringConstants({"tet4": cells[cell : cell + 1]}, objective)
        own = alone.along(points, young[cell], 0.3, changes=(change[0], change[1][cell], None))
        w = rng.normal(size=len(alone.springs))
        found = alone.gradient(points, young[cell], 0.3, weights=w)
        parts = np.append(found.points * change[0], found.young * change[1][cell])
        assert np.sum(w * own.constants) == pytest.approx(parts.sum(), abs=1e-9 * np.abs(parts).sum())


def test_second_derivatives_are_those_of_differences(jax):
    for case, (name, objective, keys) in enumerate([*CASES[:5], ("hex8", "modal", {}), ("quad4", "exact", {}), ("tri3", "frobenius", {})]):
        d = sf.Element(name).dimension
        mesh = sf.Mesh.box(name, size=[1.0, 0.8, 0.7][:d], cells=[1, 1, 1][:d])
        rng = np.random.default_rng(5)
        points = mesh.points + 0.05 * rng.uniform(-1, 1, mesh.points.shape)
        constants = sf.SpringConstants(mesh.cells, objective, **keys)
        young, poisson = np.full(len(mesh.cells[0][1]), 2.0), 0.3
        w = weighted(rng, constants(points, young, poisson))
        loss = lambda *given: sum((w * own**2).sum() for w, own in zip(w, constants.jax(*given)))
        # The first case is computed operation by operation. The others are compiled as a whole, which takes half of the time.
        whole = jax.jit if case else lambda function: function
        gradient = whole(jax.grad(loss))
        own = np.array(whole(jax.hessian(loss))(points, young, poisson))
        # The order of directions is a matter of JAX, and no other with another element.
        orders = (jax.jacfwd(jax.jacfwd(loss)), jax.jacrev(jax.jacfwd(loss)), jax.jit(jax.jacrev(jax.jacrev(loss))))
        for other in orders if case == 0 else orders[case % 3 :][:1]:
            assert np.allclose(whole(other)(points, young, poisson), own, rtol=0, atol=1e-12 * np.abs(own).max())
        v = rng.normal(size=points.shape)
        known = slope(lambda h: np.array(gradient(points + h * v, young, poisson)), 1e-3)
        found = np.einsum("aibj,bj->ai", own, v)
        assert np.abs(found - known).max() <= 1e-8 * np.abs(known).max(), (name, objective)
        # In the moduli, and mixed.
        mixed = whole(jax.jacfwd(jax.grad(loss), 1))(points, young, poisson)
        known = slope(lambda h: np.array(gradient(points, young + h * young, poisson)), 1e-2)
        assert np.abs(np.array(mixed) @ young - known).max() <= 1e-8 * np.abs(known).max()
    with pytest.raises(sf.SpringfitError, match="higher"):
        jax.jacfwd(jax.hessian(loss))(points, young, poisson)


def test_several_elements_are_one_body():
    rng = np.random.default_rng(2)
    points = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [2, 0.2], [1.9, 1.1]]) + 0.05 * rng.uniform(-1, 1, (6, 2))
    quads, triangles = [[0, 1, 2, 3]], [[1, 4, 5], [1, 5, 2]]
    constants = sf.SpringConstants({"quad4": quads, "tri3": triangles}, "frobenius")
    young = np.array([1e4, 2e4, 3e4])
    values = constants(points, young, 0.3)
    first, second = constants.blocks
    assert (first.element.name, second.place, first.contents.stop) == ("quad4", slice(1, 3), second.contents.start)
    # Each element alone, summed by the ends of springs.
    known = dict.fromkeys(map(tuple, constants.springs.tolist()), 0.0)
    for cells, own in [({"quad4": quads}, young[:1]), ({"tri3": triangles}, young[1:])]:
        alone = sf.SpringConstants(cells, "frobenius")
        for pair, k in zip(map(tuple, alone.springs.tolist()), alone(points, own, 0.3).constants):
            known[pair] += k
    assert np.allclose(values.constants, list(known.values()), rtol=1e-14)
    weights = rng.normal(size=len(known))
    found = constants.gradient(points, young, 0.3, weights=weights)
    for i in range(3):
        step = np.eye(3)[i] * young[i]
        moved = lambda h: weights @ constants(points, young + h * step, 0.3).constants
        assert found.young[i] * young[i] == pytest.approx(slope(moved, 0.1), rel=1e-9)


@pytest.mark.parametrize("name, objective, keys", [("tet4", "exact", {}), ("hex8", "exact", {}), ("hex8", "exact", {"volume": "cells"}), ("quad4", "modal", {})])
def test_values_are_those_of_the_network(name, objective, keys):
    constants, points, mesh, _ = case(name, objective, keys)
    net = sf.fit(sf.Mesh(points, mesh.cells), sf.Material(1e4, 0.3), objective, **keys)
    values = constants(points, 1e4, 0.3)
    known = {tuple(pair): rest for pair, rest in zip(net.springs.tolist(), net.rest)}
    assert np.allclose([known.get(tuple(pair), rest) for pair, rest in zip(constants.springs.tolist(), values.rest)], values.rest, rtol=1e-14)
    for own, key in [(values.contents, "constants"), (values.rest_contents, "rest")]:
        found = np.sort(np.concatenate([kind[key] for kind in net.contents])) if len(own) else own
        assert np.allclose(np.sort(own), found, rtol=1e-12)
    if objective == "exact":
        # c₀ = V (1 + μ/(λ + μ)), μ/(λ + μ) = 1 − 2ν, where both terms are of one volume.
        stiffer = constants(points, 1e4, 0.45).rest_contents
        assert keys or np.allclose(stiffer / values.rest_contents, 1.1 / 1.4, rtol=1e-12)


@pytest.mark.parametrize("objective", ["exact", "offdiag", "frobenius"])
@pytest.mark.parametrize("name", ["tet4", "hex8", "quad4"])
def test_constants_are_those_of_the_network(name, objective):
    constants, points, mesh, _ = case(name, objective, {})
    net = sf.fit(sf.Mesh(points, dict(mesh.cells)), sf.Material(1e4, 0.3), objective)
    k = constants(points, 1e4, 0.3).constants
    known = {tuple(pair): constant for pair, constant in zip(net.springs.tolist(), net.constants)}
    # A network leaves out springs that cancel.
    found = np.array([known.get(tuple(pair), 0.0) for pair in constants.springs.tolist()])
    assert np.abs(k - found).max() <= 1e-12 * np.abs(k).max()
    assert len(known) <= len(k)


@pytest.mark.parametrize(
    "call, key",
    [
        (lambda: sf.SpringConstants({"tet4": [[0, 1, 2]]}), "cells"),
        (lambda: sf.SpringConstants({"tet4": [[0, 1, 2, 3]]}, "spectral"), "objective"),
        (lambda: sf.SpringConstants({"tet4": [[0, 1, 2, 3]]}, "van-gelder"), "objective"),
        (lambda: sf.SpringConstants({"tet4": [[0, 1, 2, 3]]}, "exact", volume="patches"), "objective"),
        (lambda: sf.SpringConstants({"tet4": [[0, 1, 2, 3]]}, "offdiag", nonnegative=True), "objective"),
        (lambda: sf.SpringConstants({"tri3": [[0, 1, 2]]}, plane="both"), "plane"),
        (lambda: sf.SpringConstants({"tri3": [[0, 1, 2]]}, plane=1), "plane"),
        (lambda: sf.SpringConstants("tet4", [[0, 1, 2, 3]]), "cells"),
        (lambda: sf.SpringConstants({}), "cells"),
        (lambda: sf.SpringConstants({"tet4": [[0, 1, 2, 3]]}, energy="neo-hookean"), "energy"),
        (lambda: sf.SpringConstants({"tet4": [[0, 1, 2, 3]]}, energy="stable-mooney-rivlin"), "energy"),
        (lambda: sf.SpringConstants({"tet4": [[0, 1, 2, -1]]}), "cells"),
        (lambda: sf.SpringConstants({"tet4": [[0, 1, 2, 3]], "tri3": [[0, 1, 2]]}), "cells"),
    ],
)
def test_wrong_functions_are_refused(call, key):
    with pytest.raises(sf.SpringfitError) as error:
        constants = call()
        points = np.eye(4, 3)
        constants.gradient(points, 1.0, 0.3, weights=np.ones(len(constants.springs)))
    assert error.value.key == key, str(error.value)


@pytest.mark.parametrize("energy", ["neo-hookean", "stable-mooney-rivlin"])
def test_energies_with_other_springs_are_refused(energy):
    constants = sf.SpringConstants({"tet4": [[0, 1, 2, 3]]}, energy=energy)
    with pytest.raises(sf.SpringfitError) as error:
        constants(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float), 1.0, 0.3)
    assert error.value.key == "energy"


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
        ((points, 1e4, 0.3), {"contents": [[1.0]]}, "contents"),
        ((points, 1e4, 0.3), {"rest": weights[1:]}, "rest"),
        ((points, 1e4, 0.3), {"rest_contents": np.ones(3)}, "rest_contents"),
        ((points, np.full(71, 1e4), 0.3), {}, "young"),
        ((points, np.full(72, -1e4), 0.3), {}, "young[0]"),
        ((points, 1e4, np.where(np.arange(72) == 5, np.nan, 0.3)), {}, "poisson[5]"),
        ((points, np.ma.array(np.full(72, 1e4), mask=np.arange(72) > 5), 0.3), {}, "young"),
        ((points, np.full(72, 1e4).astype(complex), 0.3), {}, "young"),
    ]:
        with pytest.raises(sf.SpringfitError) as error:
            constants.gradient(*given, **{"weights": weights, **options})
        assert key is None or key in str(error.value.key), str(error.value)


def test_constants_keep_their_cells():
    mesh = sf.Mesh.box("tet4", size=[1.0, 1.0, 1.0], cells=[2, 1, 1])
    cells = mesh.cells[0][1].copy()
    constants = sf.SpringConstants({"tet4": cells})
    known = constants(mesh.points, 1e4, 0.3)
    cells[:] = cells[0]
    for array in (constants.springs, constants.blocks[0].cells):
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
    k = constants(points, 1e4, 0.3).constants
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
    k, other, *_ = constants.torch(x, young, poisson)
    (k.square().sum() + other.square().sum()).backward()
    known = constants.gradient(points, 1e4, 0.3, weights=2 * k.detach().numpy(), contents=2 * other.detach().numpy())
    assert np.allclose(x.grad.numpy(), known.points, rtol=1e-12)
    assert young.grad.item() == pytest.approx(known.young) and poisson.grad.item() == pytest.approx(known.poisson)
    small = sf.SpringConstants(sf.Mesh.box("tet4", size=[1, 1, 1], cells=[1, 1, 1]).cells, "frobenius")
    corner = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[1, 1, 1]).points + 0.05 * rng.uniform(-1, 1, (8, 3))
    own = lambda *values: [torch.tensor(value, dtype=torch.float64, requires_grad=True) for value in values]
    given = own(corner, np.full(len(small.blocks[0].cells), 1.0), 0.3)
    assert torch.autograd.gradcheck(lambda *given: tuple(small.torch(*given)), given)
    assert torch.autograd.gradgradcheck(lambda *given: tuple(small.torch(*given)), given)


def test_jax_passes_gradients_on(jax):
    constants, points, _, _ = case("tet4", "exact", {})

    @jax.jit
    def loss(x, young, poisson):
        k, other, *_ = constants.jax(x, young, poisson)
        return (k**2).sum() + (other**2).sum()

    slopes = jax.grad(loss, (0, 1, 2))(points, 1e4, 0.3)
    k, other, *_ = constants(points, 1e4, 0.3)
    known = constants.gradient(points, 1e4, 0.3, weights=2 * k, contents=2 * other)
    assert np.allclose(slopes[0], known.points, rtol=1e-12)
    assert float(slopes[1]) == pytest.approx(known.young) and float(slopes[2]) == pytest.approx(known.poisson)


def test_jax_maps_over_bodies(jax):
    constants, points, _, rng = case("tet4", "exact", {})
    many = points + 0.01 * rng.uniform(-1, 1, (3, *points.shape))
    moduli = np.array([1e3, 1e4, 1e5])

    def loss(x, young):
        k, other, *_ = constants.jax(x, young, 0.3)
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
    constants = sf.SpringConstants(mesh.cells, "exact")
    k = constants(mesh.points, 1.0, 0.3).constants
    gone = k == 0.0
    assert gone.any()
    weights = gone.astype(float) * np.random.default_rng(8).normal(size=k.shape)
    found = constants.gradient(mesh.points, 1.0, 0.3, weights=weights).points
    v = np.random.default_rng(9).normal(size=found.shape)
    along = lambda h: weights @ constants(mesh.points + h * v, 1.0, 0.3)[0]
    central = lambda h: (along(h) - along(-h)) / (2 * h)
    known = (4 * central(5e-5) - central(1e-4)) / 3
    assert abs(known) > 1e-3 and np.sum(found * v) == pytest.approx(known, rel=1e-6)

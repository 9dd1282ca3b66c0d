"""Displacements are solutions, and their derivatives those of differences."""

import time

import numpy as np
import pytest

import springfit as sf

CASES = [("tet4", "exact"), ("tet4", "offdiag"), ("hex8", "exact"), ("hex8", "modal"), ("quad4", "exact"), ("tri3", "frobenius")]


def case(name, objective):
    d = sf.Element(name).dimension
    rng = np.random.default_rng(3)
    mesh = sf.Mesh.box(name, size=[1.0, 0.8, 0.7][:d], cells=[3, 2, 2][:d])
    points = mesh.points + 0.04 * rng.uniform(-1, 1, mesh.points.shape)
    constants = sf.SpringConstants(mesh.cells, objective)
    values = constants(points, 1e4 * rng.uniform(0.5, 2.0, len(mesh.cells[0][1])), 0.3)
    held = np.zeros(points.shape, bool)
    held[mesh.groups["xmin"]] = True
    held[mesh.groups["xmax"], 0] = True
    displacement = np.zeros(points.shape)
    displacement[mesh.groups["xmax"], 0] = 0.1
    return constants, points, values, held, displacement, 20 * rng.normal(size=points.shape), rng


def slope(function, size):
    """The derivative at zero. Richardson's: the errors of two central differences cancel to the fourth order."""
    central = lambda h: (function(h) - function(-h)) / (2 * h)
    return (4 * central(size / 2) - central(size)) / 3


@pytest.mark.parametrize("large", [False, True])
@pytest.mark.parametrize("name, objective", CASES)
def test_gradients_are_those_of_differences(name, objective, large):
    constants, points, values, held, displacement, forces, rng = case(name, objective)
    statics = sf.Statics(constants, held, large=large)
    solution = statics(points, values, forces=forces, displacement=displacement)
    w = rng.normal(size=points.shape)
    found = solution.gradient(w)
    given = [points, *values, forces, displacement]
    own = [found.points, *found.values, found.forces, found.displacement]

    def loss(points, *rest):
        *values, forces, displacement = rest
        return np.sum(w * statics(points, sf.SpringValues(*values), forces=forces, displacement=displacement).displacement)

    changes = []
    for i, (value, slopes) in enumerate(zip(given, own)):
        assert slopes.shape == value.shape
        change = rng.normal(size=value.shape) * (np.abs(value).max(initial=0.0) if 0 < i < 6 else 1.0)
        if i == 6:
            change = np.where(held, change, 0.0)
        changes.append(change)
        if not np.any(change):
            continue
        moved = lambda h: loss(*(x + h * change if j == i else x for j, x in enumerate(given)))
        # Newton's method ends at 1e-10 of the forces; steps in positions and rest lengths are short, because the tangent depends on them.
        known, size = slope(moved, 1e-4 if i in (0, 3, 6) else 1e-3), np.sum(np.abs(slopes * change))
        assert np.sum(slopes * change) == pytest.approx(known, rel=1e-8, abs=1e-8 * size), (i, statics.large)
    along = solution.along(points=changes[0], values=sf.SpringValues(*changes[1:5]), forces=changes[5], displacement=changes[6])
    parts = [np.sum(slopes * change) for slopes, change in zip(own, changes)]
    assert np.sum(w * along) == pytest.approx(sum(parts), abs=1e-11 * sum(map(abs, parts)))
    assert np.array_equal(solution.along(), np.zeros(points.shape))


@pytest.mark.filterwarnings("ignore:.*beyond the linear theory")
@pytest.mark.parametrize("name, objective", CASES)
def test_solutions_are_those_of_the_network(name, objective):
    constants, points, values, held, displacement, forces, _ = case(name, objective)
    mesh = sf.Mesh(points, [(block.element, block.cells) for block in constants.blocks])
    net = sf.fit(mesh, sf.Material(1e4, 0.3), objective)
    values = constants(points, 1e4, 0.3)
    small = sf.Statics(constants, held)(points, values, forces=forces, displacement=displacement)
    assert np.allclose(small.displacement, net.solve(fix=held, forces=forces, displacement=displacement), rtol=0, atol=1e-10)
    large = sf.Statics(constants, held, large=True)(points, values, forces=forces, displacement=displacement)
    left = np.where(held, 0.0, net.forces(points + large.displacement) + forces)
    assert np.abs(left).max() <= 1e-8 * np.abs(forces).max()
    assert np.array_equal(large.displacement[held], displacement[held])
    near = sf.Statics(constants, held, large=True)(points, values, forces=forces, displacement=displacement, guess=large.displacement)
    assert np.allclose(near.displacement, large.displacement, atol=1e-8)


def test_a_modulus_of_each_cell_has_a_gradient():
    constants, points, _, held, displacement, forces, rng = case("tet4", "exact")
    young = 1e4 * rng.uniform(0.5, 2.0, len(constants.blocks[0].cells))
    for large in (False, True):
        statics = sf.Statics(constants, held, large=large)
        measured = 0.01 * rng.normal(size=points.shape)

        def loss(young):
            u = statics(points, constants(points, young, 0.3), forces=forces, displacement=displacement).displacement
            return np.sum((u - measured) ** 2)

        solution = statics(points, constants(points, young, 0.3), forces=forces, displacement=displacement)
        of = solution.gradient(2 * (solution.displacement - measured)).values
        found = constants.gradient(
            points, young, 0.3, weights=of.constants, contents=of.contents, rest=of.rest, rest_contents=of.rest_contents
        ).young
        for cell in (0, 17, 40):
            step = np.eye(len(young))[cell] * young[cell]
            known = slope(lambda h: loss(young + h * step), 0.02)
            assert found[cell] * young[cell] == pytest.approx(known, rel=1e-7, abs=1e-8 * np.abs(found * young).max())


SAMPLED = {"law": "neo-hookean", "shapes": {"count": 40}}


@pytest.mark.filterwarnings("ignore:.*beyond the linear theory")
@pytest.mark.parametrize("large", [False, True])
@pytest.mark.parametrize("keys", [{}, {"energy": "neo-hookean"}, {**SAMPLED, "force": "k1*s + k2*s^2"}], ids=str)
def test_a_network_has_gradients(keys, large):
    mesh = sf.Mesh.box("hex8", size=[1.0, 0.5, 0.5], cells=[2, 1, 1])
    net = (sf.sampled if "law" in keys else sf.fit)(mesh, sf.Material(1e4, 0.3), **keys)
    assert any("law" in springs for springs in net.contents) == bool(keys), [sorted(springs) for springs in net.contents]
    statics = sf.Statics(net, "xmin", large=large)
    forces = np.zeros(mesh.points.shape)
    forces[mesh.groups["xmax"], 2] = 5.0
    solution = statics(mesh.points, statics.values, forces=forces)
    if large:
        assert np.allclose(mesh.points + solution.displacement, net.equilibrium("xmin", forces), atol=1e-9)
    else:
        assert np.allclose(solution.displacement, net.solve("xmin", forces), atol=1e-12)
    found = solution.gradient(forces).values
    for key, own in (("constants", found.constants), ("contents", found.contents), ("rest_contents", found.rest_contents)):
        value = getattr(statics.values, key)
        change = value * np.random.default_rng(4).normal(size=value.shape)
        moved = lambda h: np.sum(forces * statics(
            mesh.points, statics.values._replace(**{key: value + h * change}), forces=forces).displacement)
        # Terms of both signs are left where springs with and without a rest measure balance.
        size = np.abs(own * change).sum()
        assert own @ change == pytest.approx(slope(moved, 1e-3), rel=1e-7, abs=1e-8 * size)
    change = np.random.default_rng(5).normal(size=mesh.points.shape)
    moved = lambda h: np.sum(forces * statics(mesh.points + h * change, statics.values, forces=forces).displacement)
    points = solution.gradient(forces).points
    assert np.sum(points * change) == pytest.approx(slope(moved, 1e-4), rel=1e-7, abs=1e-8 * np.abs(points * change).sum())


@pytest.mark.filterwarnings("ignore:.*beyond the linear theory")
def test_laws_without_derivatives_are_refused():
    mesh = sf.Mesh.box("hex8", size=[1.0, 0.5, 0.5], cells=[2, 1, 1])
    for force, word in ((lambda s, k: k * s, "expressions"), ("k*s^3", "slope at rest")):
        net = sf.sampled(mesh, sf.Material(1e4, 0.3), force=force, **SAMPLED)
        with pytest.raises(sf.SpringfitError, match=word):
            sf.Statics(net, "xmin")(mesh.points, sf.Statics(net, "xmin").values)


def test_a_gradient_costs_less_than_a_solution():
    mesh = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[16, 16, 16])
    constants = sf.SpringConstants(mesh.cells)
    values = constants(mesh.points, 1e4, 0.3)
    statics = sf.Statics(constants, mesh.groups["xmin"])
    forces = np.ones(mesh.points.shape)

    def least(work):
        times = []
        for _ in range(3):
            start = time.process_time()
            work()
            times.append(time.process_time() - start)
        return min(times)

    scales = iter(range(1, 100))
    # Other springs each time, whose factor is not known.
    solved = lambda: statics(mesh.points, values._replace(constants=values.constants * (1 + 1e-9 * next(scales))), forces=forces)
    assert least(lambda: solved().gradient(forces)) <= 2 * least(solved), "at most twice a solution"


@pytest.mark.parametrize("large", [False, True])
def test_several_loads_are_several_solutions(large):
    constants, points, values, held, displacement, forces, rng = case("tet4", "exact")
    statics = sf.Statics(constants, held, large=large)
    loads, moved = np.stack([forces, -0.5 * forces, 0 * forces]), np.stack([displacement, 0 * displacement, displacement])
    w = rng.normal(size=loads.shape)
    change = rng.normal(size=loads.shape)
    for f, u in [(loads, displacement), (loads, moved), (forces, moved)]:
        solution = statics(points, values, forces=f, displacement=u)
        each = [statics(points, values, forces=f if f.ndim == 2 else f[i], displacement=u if u.ndim == 2 else u[i]) for i in range(3)]
        assert np.allclose(solution.displacement, [own.displacement for own in each], rtol=0, atol=1e-12)
        found, own = solution.gradient(w), [own.gradient(w) for own, w in zip(each, w)]
        assert np.allclose(found.points, sum(g.points for g in own))
        assert np.allclose(found.values.constants, sum(g.values.constants for g in own))
        gathered = lambda all, like: np.stack(all) if like.ndim == 3 else sum(all)
        assert np.allclose(found.forces, gathered([g.forces for g in own], f))
        assert np.allclose(found.displacement, gathered([g.displacement for g in own], u))
        along = solution.along(forces=change if f.ndim == 3 else change[0], points=change[0])
        known = [one.along(forces=change[i] if f.ndim == 3 else change[0], points=change[0]) for i, one in enumerate(each)]
        assert np.allclose(along, known, rtol=1e-10)
    with pytest.raises(sf.SpringfitError) as error:
        statics(points, values, forces=loads, displacement=moved[:2])
    assert error.value.key == "displacement"


def test_jax_passes_through_solutions(jax):
    constants, points, _, held, displacement, forces, rng = case("tet4", "exact")
    young, w = np.full(len(constants.blocks[0].cells), 1e4), rng.normal(size=points.shape)
    for large in (False, True):
        statics = sf.Statics(constants, held, large=large)

        def loss(points, young, poisson, forces, displacement):
            return (w * statics.jax(points, constants.jax(points, young, poisson), forces, displacement)).sum()

        given = (points, young, 0.3, forces, displacement)
        slopes = jax.jit(jax.grad(loss, (0, 1, 2, 3, 4)))(*given)
        change = [rng.normal(size=np.shape(own)) for own in given]
        change[1], change[4] = change[1] * 1e4, np.where(held, change[4], 0.0)
        _, along = jax.jvp(loss, given, tuple(map(np.asarray, change)))
        parts = [np.sum(np.asarray(own) * c) for own, c in zip(slopes, change)]
        assert float(along) == pytest.approx(sum(parts), abs=1e-11 * sum(map(abs, parts)))
        moved = lambda h: float(loss(*(own + h * c for own, c in zip(given, change))))
        assert float(along) == pytest.approx(slope(moved, 3e-4), abs=1e-7 * sum(map(abs, parts)))
        solve = lambda f: statics.jax(points, constants.jax(points, young, 0.3), f, displacement)
        stacked = np.stack([forces, 0.5 * forces])
        assert np.allclose(jax.vjp(solve, stacked)[1](np.stack([w, w]))[0][1], jax.vjp(solve, stacked[1])[1](w)[0], rtol=1e-8)
        many = jax.vmap(loss, (None, 0, None, None, None))(points, np.stack([young, 2 * young]), *given[2:])
        assert np.allclose(many, [loss(points, own, *given[2:]) for own in (young, 2 * young)], rtol=1e-12)
        with pytest.raises(sf.SpringfitError, match="first order"):
            jax.hessian(loss, 1 if large else 0)(*given)


@pytest.mark.parametrize("name, objective", [("tet4", "exact"), ("quad4", "exact"), ("hex8", "offdiag")])
def test_jax_has_second_derivatives_of_small_displacements(name, objective, jax):
    constants, points, _, held, displacement, forces, rng = case(name, objective)
    statics = sf.Statics(constants, held)
    shares = rng.normal(size=(3, len(constants.blocks[0].cells)))
    scale = 1e-3 * np.abs(np.asarray(statics.jax(points, constants.jax(points, 1e4, 0.3), forces, displacement))).max()
    stacked = np.stack([forces, 0.3 * forces[::-1]])

    def loss(logs, poisson, forces, displacement):
        u = statics.jax(points, constants.jax(points, 1e4 * jax.numpy.exp(logs @ shares), poisson), forces, displacement)
        return ((u / scale) ** 2).sum() + (u / scale).sum()

    given = (0.2 * rng.normal(size=3), 0.3, stacked, displacement)
    change = [rng.normal(size=np.shape(own)) for own in given]
    change[1], change[2], change[3] = 0.05, 0.3 * stacked, 0.3 * displacement
    slopes = jax.grad(loss, (0, 1, 2, 3))
    # The change of the gradient along a line, by differences of the gradient, which other tests compare with those of the values.
    _, turned = jax.jvp(slopes, given, tuple(map(np.asarray, change)))
    for place in range(4):
        at = lambda h: np.asarray(slopes(*(own + h * c for own, c in zip(given, change)))[place])
        wanted = slope(at, 1e-3)
        assert np.allclose(turned[place], wanted, rtol=0, atol=1e-7 * np.abs(wanted).max()), place
    # Both orders of directions, and the symmetry of the matrix.
    of_logs = lambda logs: loss(logs, *given[1:])
    matrix = np.asarray(jax.hessian(of_logs)(given[0]))
    assert np.allclose(matrix, matrix.T, rtol=0, atol=1e-9 * np.abs(matrix).max())
    assert np.allclose(jax.jacfwd(jax.jacfwd(of_logs))(given[0]), matrix, rtol=0, atol=1e-9 * np.abs(matrix).max())


def test_torch_passes_through_solutions():
    torch = pytest.importorskip("torch", reason="not run: torch is not installed; .ci/petsc runs this with Debian's")
    mesh = sf.Mesh.box("tri3", size=[1, 1], cells=[2, 1])
    rng = np.random.default_rng(1)
    points = mesh.points + 0.05 * rng.uniform(-1, 1, mesh.points.shape)
    constants = sf.SpringConstants(mesh.cells)
    own = lambda value: torch.tensor(value, dtype=torch.float64, requires_grad=True)
    given = own(points), own(np.ones(4)), own(0.3), own(0.01 * rng.normal(size=points.shape))
    for large in (False, True):
        statics = sf.Statics(constants, mesh.groups["xmin"], large=large)
        solved = lambda x, young, poisson, f: statics.torch(x, constants.torch(x, young, poisson), f)
        assert torch.autograd.gradcheck(solved, given)


def test_wrong_arrays_are_refused():
    constants, points, values, held, displacement, forces, _ = case("tet4", "exact")
    statics = sf.Statics(constants, held)
    nan = np.full_like(forces, np.nan)
    for call, key in [
        (lambda: sf.Statics(constants, "xmin"), "fix"),
        (lambda: sf.Statics(values, held), "springs"),
        (lambda: sf.Statics(constants, held).values, "springs"),
        (lambda: sf.Statics(constants, [999])(points, values), "fix"),
        (lambda: sf.Statics(constants, [0])(points, values, forces=forces), "fix"),
        (lambda: statics(points[:, :2], values), "fix"),
        (lambda: statics(points[:5], values), None),
        (lambda: statics(points, values[:2]), "values"),
        (lambda: statics(points, values._replace(constants=values.constants[1:])), "constants"),
        (lambda: statics(points, values._replace(contents=values.contents * np.nan)), "contents[0]"),
        (lambda: statics(points, values, forces=nan), "forces[0]"),
        (lambda: statics(points, values, forces=forces[1:]), "forces"),
        (lambda: statics(points, values, displacement=np.ones_like(points)), "displacement"),
        (lambda: statics(points, values).gradient(forces[1:]), "weights"),
        (lambda: sf.Statics(constants, held, large=True)(points, values, forces=1e6 * forces), "forces"),
    ]:
        with pytest.raises(sf.SpringfitError) as error:
            call()
        assert key is None or error.value.key == key, (key, str(error.value))

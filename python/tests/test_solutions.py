"""Solutions of networks: linear ones, equilibria and motions, beside SciPy, differences and laws of motion."""

import copy
import pickle
import warnings

import numpy as np
import pytest

import springfit as sf
from conftest import raised

MATERIAL = sf.Material(young=5e5, poisson=0.3, density=1000.0)
GRAVITY = np.array([0, 0, -9.81])


def bar(element="tet4", cells=(10, 2, 2), **keys):
    mesh = sf.Mesh.box(element, size=[0.1, 0.02, 0.02], cells=list(cells))
    return sf.fit(mesh, MATERIAL, **keys)


def known(net, held, forces, moved):
    """By SciPy."""
    from scipy.sparse.linalg import spsolve

    k, free = net.stiffness().tocsc(), ~held.ravel()
    u = moved.ravel().copy()
    u[free] = spsolve(k[free][:, free], (forces.ravel() - k @ u)[free])
    return u.reshape(held.shape)


def softly(call, *given, **keys):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return call(*given, **keys)


def test_a_matrix_has_each_place_once_in_short_numbers():
    for net in (bar(), bar("hex8", (4, 2, 2)), bar(objective="offdiag")):
        for x in (None, net.points + 0.001 * np.random.default_rng(1).uniform(-1, 1, net.points.shape)):
            matrix = net.stiffness(x)
            assert matrix.indices.dtype == np.int32 and matrix.indptr.dtype == np.int32
            copy = matrix.copy()
            copy.has_canonical_format = copy.has_sorted_indices = False
            copy.sum_duplicates()
            assert np.array_equal(copy.indices, matrix.indices) and np.array_equal(copy.indptr, matrix.indptr)
            assert abs(matrix - matrix.T).max() <= 1e-12 * abs(matrix).max()
    rods = sf.Mesh([[0.0], [1.0], [3.0]], {"bar2": [[0, 1], [1, 2]]})
    stiffness = sf.stiffness(rods, sf.Material(10.0, 0.3, area=1.0))
    assert np.allclose(stiffness.toarray(), [[10, -10, 0], [-10, 15, -5], [0, -5, 5]])
    mass = sf.mass(rods, sf.Material(10.0, 0.3, area=1.0, density=6.0))
    assert np.allclose(mass.toarray(), [[2, 1, 0], [1, 6, 2], [0, 2, 4]])


def test_one_factor_solves_many_loads():
    net = bar()
    rng = np.random.default_rng(2)
    fix = ["xmin", "xmax"]
    solve = net.factorized(fix)
    assert solve.is_stable and solve.held.sum() == 2 * 9 * 3
    forces = 1e-3 * rng.uniform(-1, 1, (7, *net.points.shape))
    moved = np.where(solve.held, 1e-4 * rng.uniform(-1, 1, forces.shape), 0.0)
    found = solve(forces, moved)
    for u, f, held in zip(found, forces, moved):
        expected = known(net, solve.held, f, held)
        assert np.abs(u - expected).max() <= 1e-10 * np.abs(expected).max()
        assert np.abs(net.solve(fix, f, held) - expected).max() <= 1e-10 * np.abs(expected).max()
    # One shape of supports goes with all loads, and one load with all supports.
    assert np.allclose(solve(forces, moved[0])[3], known(net, solve.held, forces[3], moved[0]), rtol=1e-8, atol=1e-12)
    assert np.allclose(solve(forces[0], moved)[3], known(net, solve.held, forces[0], moved[3]), rtol=1e-8, atol=1e-12)
    assert solve(forces[:0]).shape == (0, *net.points.shape)
    for again in (pickle.loads(pickle.dumps(solve)), copy.deepcopy(solve)):
        assert np.array_equal(again(forces, moved), found)
    with pytest.raises(ValueError):
        solve.held[0] = False


def test_groups_are_supports_loads_and_displacements():
    net = bar("hex8", (4, 2, 2))
    groups = net.mesh.groups
    u = net.solve("xmin", {"xmax": [0, 0, -1e-3]})
    forces = np.zeros_like(net.points)
    # A face of 2 × 2 equal quadrilaterals: a node has the share of those around it.
    end = groups["xmax"]
    y, z = net.points[end, 1], net.points[end, 2]
    edge = lambda x: np.where(np.isclose(x, 0.01), 1.0, 0.5)
    forces[end, 2] = -1e-3 * edge(y) * edge(z) / 4
    assert forces[:, 2].sum() == pytest.approx(-1e-3, rel=1e-12)
    assert np.allclose(u, net.solve(fix="xmin", forces=forces), rtol=1e-12, atol=1e-18)
    pulled = net.solve(["xmin", "xmax"], displacement={"xmax": [1e-4, 0, 0]})
    assert np.allclose(pulled[end], [1e-4, 0, 0]) and np.allclose(pulled[groups["xmin"]], 0)
    for call, key in [
        (lambda: net.solve(["xmin", "left"]), "fix"),
        (lambda: net.solve("xmin", {"left": [0, 0, 1]}), "forces"),
        (lambda: net.solve("xmin", {"xmax": [0, 1]}), "forces.xmax"),
        (lambda: net.solve("xmin", displacement={"xmax": [0, 0, 1]}), "displacement"),
        (lambda: net.solve("xmin", np.zeros((2, 3, 3))), "forces"),
        (lambda: net.solve("xmin", np.full(net.points.shape, np.nan)), "forces[0]"),
        (lambda: net.solve(None), "fix"),
    ]:
        raised(call, key)


def test_what_is_beyond_the_linear_theory_is_a_warning():
    mesh = sf.Mesh.box("tet4", size=[0.1, 0.02, 0.02], cells=[20, 4, 4])
    soft = sf.fit(mesh, sf.Material(young=10e3, poisson=0.3, density=1000.0))
    with pytest.warns(UserWarning, match=r"strains of up to \d+ % \(bound 10 %\) and rotations of up to .* rad .* beyond the linear theory"):
        soft.solve(fix="xmin", forces=soft.masses[:, None] * GRAVITY)
    # The words of `springfit run` about the same body.
    scene = {
        "mesh": {"box": {"element": "tet4", "size": [0.1, 0.02, 0.02], "cells": [20, 4, 4]}},
        "material": {"young": "10 kPa", "poisson": 0.3, "density": 1000},
        "fit": [{"objective": "exact"}],
        "fix": [{"group": "xmin"}],
        "load": [{"name": "weight", "group": "body", "body": [0, 0, -9810]}],
    }
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        net = soft.with_constants()
        net.solve(fix="xmin", forces=soft.masses[:, None] * GRAVITY)
    told = str(heard[0].message).split(" are beyond")[0].split(" and ")
    notes = " ".join(sf.run(scene).record["notes"])
    assert all(words.split(" (bound")[0][:22] in notes for words in told), (told, notes)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        stiff = bar()
        stiff.solve(fix="xmin", forces=stiff.masses[:, None] * GRAVITY)
    # Without cells the springs tell.
    bare = sf.Network(soft.points, soft.springs, soft.constants, rest=soft.rest, contents=soft.contents)
    with pytest.warns(UserWarning, match="beyond the linear theory"):
        bare.solve(fix=mesh.groups["xmin"], forces=soft.masses[:, None] * GRAVITY)


@pytest.mark.parametrize("element, cells, keys", [("tet4", (20, 4, 4), {}), ("hex8", (6, 2, 2), {}), ("tet4", (6, 2, 2), {"objective": "offdiag"})])
def test_an_equilibrium_has_no_forces_left(element, cells, keys):
    mesh = sf.Mesh.box(element, size=[0.1, 0.02, 0.02], cells=list(cells))
    net = sf.fit(mesh, sf.Material(young=10e3, poisson=0.3, density=1000.0), **keys)
    weight = net.masses[:, None] * GRAVITY
    x = net.equilibrium("xmin", weight)
    free = np.ones(len(x), bool)
    free[mesh.groups["xmin"]] = False
    assert np.abs((net.forces(x) + weight)[free]).max() <= 1e-8 * np.abs(weight).max()
    assert np.array_equal(x[~free], net.points[~free])
    # Near it, it is found from there; the linear answer is another one.
    again = net.equilibrium("xmin", weight, x0=x + 1e-4 * free[:, None])
    assert np.abs(again - x).max() <= 1e-7 * np.abs(x - net.points).max()
    assert np.abs(x - net.points).max() < 0.11 < np.abs(softly(net.solve, "xmin", weight)).max()


def test_an_equilibrium_under_a_small_load_is_the_linear_answer():
    net = bar()
    f = {"xmax": [0, 0, -1e-9]}
    u, x = net.solve("xmin", f), net.equilibrium("xmin", f)
    assert np.abs(x - net.points - u).max() <= 1e-5 * np.abs(u).max()
    moved = {"xmax": [0.03, 0, 0]}
    x = net.equilibrium(["xmin", "xmax"], displacement=moved)
    assert np.allclose(x[net.mesh.groups["xmax"], 0], 0.13)
    # The exact network is a stable neo-Hookean body: held sideways nowhere else, it becomes thinner.
    assert np.ptp(x[:, 1]) == pytest.approx(0.02) and x[np.isclose(net.points[:, 0], 0.05), 1].max() < 0.0195


def test_a_motion_keeps_its_energy_and_falls_freely():
    net = bar(cells=(4, 1, 1))
    times, x, v = net.simulate(gravity=GRAVITY, dt=1e-3, steps=50, every=5)
    assert times.shape == (11,) and x.shape == v.shape == (11, *net.points.shape)
    assert np.allclose(v[-1], GRAVITY * 0.05, atol=1e-9)
    rng = np.random.default_rng(3)
    v0 = 0.05 * rng.uniform(-1, 1, net.points.shape)
    energy = lambda x, v: net.energy(x) + 0.5 * np.sum(net.masses[:, None] * v**2)
    longest = 1e-5
    _, x, v = net.simulate(v0=v0, dt=longest, steps=400, method="symplectic-euler", every=400)
    start = energy(net.points, v0)
    assert energy(x[-1], v[-1]) == pytest.approx(start, rel=2e-2)
    ends = {}
    for method in ("implicit-euler", "bdf2", "newmark", "symplectic-euler"):
        _, x, _ = net.simulate("xmin", gravity=GRAVITY, dt=longest, steps=300, method=method, every=300)
        ends[method] = x[-1] - net.points
    for method, u in ends.items():
        assert np.abs(u - ends["newmark"]).max() <= 0.03 * np.abs(ends["newmark"]).max(), method
    # With much damping it comes to rest where the equilibrium is.
    weight = net.masses[:, None] * GRAVITY
    _, x, _ = net.simulate("xmin", weight, dt=0.02, steps=300, damping=(30.0, 0.0), every=300)
    rest = net.equilibrium("xmin", weight)
    assert np.abs(x[-1] - rest).max() <= 1e-3 * np.abs(rest - net.points).max()


def test_a_motion_calls_back_and_names_its_faults():
    net = bar(cells=(4, 1, 1))
    seen = []
    assert net.simulate("xmin", gravity=GRAVITY, dt=1e-3, steps=6, every=2, callback=lambda t, x, v: seen.append((t, x, v))) is None
    assert [round(t, 6) for t, _, _ in seen] == [0, 0.002, 0.004, 0.006]
    _, x, v = net.simulate("xmin", gravity=GRAVITY, dt=1e-3, steps=6, every=2)
    assert np.array_equal(x[-1], seen[-1][1]) and np.array_equal(v[-1], seen[-1][2])

    def stop(t, x, v):
        raise KeyError("stop")

    with pytest.raises(sf.SpringfitError) as error:
        net.simulate("xmin", dt=1e-3, steps=6, callback=stop)
    assert isinstance(error.value.__cause__, KeyError)
    bare = sf.Network(net.points, net.springs, net.constants, rest=net.rest, contents=net.contents)
    for call, key in [
        (lambda: net.simulate(dt=-1, steps=1), "dt"),
        (lambda: net.simulate(dt=1.0, steps=1, method="symplectic-euler"), "dt"),
        (lambda: net.simulate(dt=1e-3, steps=0), "steps"),
        (lambda: net.simulate(dt=1e-3, steps=1, method="euler"), "method"),
        (lambda: net.simulate(dt=1e-3, steps=1, damping="much"), "damping"),
        (lambda: net.simulate(dt=1e-3, steps=1, x0=net.points[:3]), "x0"),
        (lambda: net.simulate(dt=1e-3, steps=1, gravity=[1, 2]), "gravity"),
        (lambda: bare.simulate(dt=1e-3, steps=1), "masses"),
    ]:
        raised(call, key)


def test_shapes_may_be_many():
    for net in (bar(), bar("hex8", (3, 2, 2)), bar(objective="offdiag")):
        rng = np.random.default_rng(4)
        x = net.points + 0.002 * rng.uniform(-1, 1, (2, 3, *net.points.shape))
        energies, forces = net.energy(x), net.forces(x)
        assert energies.shape == (2, 3) and forces.shape == x.shape
        for i in np.ndindex(2, 3):
            assert energies[i] == net.energy(x[i]) and np.array_equal(forces[i], net.forces(x[i]))
        many = np.tile(x[0, :1], (250, 1, 1))
        assert np.allclose(net.forces(many), forces[0, 0], rtol=1e-10, atol=1e-12 * np.abs(forces).max())
        assert net.energy(x[:0]).shape == (0, 3)
    with pytest.raises(sf.SpringfitError) as error:
        net.forces(np.where(np.arange(x.size).reshape(x.shape) == 5, np.nan, x))
    assert error.value.key == "x[0, 1]"


def test_a_plain_newton_loop_on_the_arrays_finds_the_equilibrium():
    """As the book shows it."""
    from scipy.sparse.linalg import spsolve

    net = bar()
    weight = net.masses[:, None] * GRAVITY
    free = np.ones(net.points.shape, bool)
    free[net.mesh.groups["xmin"]] = False
    free, x = np.flatnonzero(free), net.points.copy()
    for _ in range(20):
        left = (net.forces(x) + weight).ravel()[free]
        if np.abs(left).max() < 1e-12:
            break
        x.ravel()[free] += spsolve(net.stiffness(x)[free][:, free].tocsc(), left)
    expected = net.equilibrium("xmin", weight)
    assert np.abs(x - expected).max() <= 1e-9 * np.abs(expected - net.points).max()


def test_matrices_and_solutions_are_those_of_scikit_fem():
    skfem = pytest.importorskip("skfem")
    from skfem.helpers import ddot, sym_grad, trace
    from skfem.models.elasticity import lame_parameters

    mesh = skfem.MeshTet.init_tensor(*(np.linspace(0, a, n) for a, n in ((0.1, 6), (0.02, 3), (0.02, 3))))
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementTetP1()))
    lam, mu = lame_parameters(5e5, 0.3)
    stiff = skfem.BilinearForm(
        lambda u, v, w: 2 * mu * ddot(sym_grad(u), sym_grad(v)) + lam * trace(sym_grad(u)) * trace(sym_grad(v))
    ).assemble(basis)
    own = sf.Mesh(mesh.p.T, {"tet4": mesh.t.T})
    assert np.array_equal(own.points, mesh.p.T)
    for ours in (sf.stiffness(own, MATERIAL), sf.fit(own, MATERIAL).stiffness()):
        # Its degrees of freedom have the same numbers: point · 3 + axis.
        assert abs(ours - stiff).max() <= 1e-12 * abs(stiff).max()
    f = np.zeros(mesh.p.T.shape)
    f[mesh.p[0] > 0.0999, 2] = -1e-3
    u = skfem.solve(*skfem.condense(stiff, f.ravel(), D=basis.get_dofs(lambda x: x[0] < 1e-9).flatten()))
    found = sf.fit(own, MATERIAL).solve(np.flatnonzero(mesh.p[0] < 1e-9), f)
    assert np.abs(found.ravel() - u).max() <= 1e-9 * np.abs(u).max()


@pytest.mark.parametrize("name", ["springs", "factorized", "motion", "network"])
def test_the_examples_of_docstrings_run(name):
    import doctest
    import importlib

    found = doctest.testmod(importlib.import_module(f"springfit.{name}"))
    assert found.failed == 0 and (found.attempted > 0 or name != "springs")


def test_forces_on_what_is_held_alone_are_warned_of():
    mesh = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[2, 2, 2])
    net = sf.fit(mesh, sf.Material(1e6, 0.3))
    force = np.zeros(mesh.points.shape)
    force[mesh.groups["zmin"], 2] = 1.0
    constants = sf.SpringConstants(mesh.cells)
    statics = sf.Statics(constants, mesh.groups["zmin"])
    for solve in (
        lambda f: net.solve(fix="zmin", forces=f),
        lambda f: net.equilibrium(fix="zmin", forces=f),
        lambda f: statics(mesh.points, constants(mesh.points, 1e6, 0.3), forces=f),
    ):
        with pytest.warns(UserWarning, match="all forces act on what is held"):
            solve(force)
    with pytest.warns(UserWarning, match="all forces of load 1 act on what is held"):
        net.solve(fix="zmin", forces=np.stack([np.flip(force, 0), force]))
    moved = np.where(mesh.points[:, 2:] < 1e-9, 1e-3, 0.0) * [0, 0, 1.0]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        net.solve(fix="zmin")
        net.solve(fix="zmin", forces=force, displacement=moved)
        net.solve(fix="zmin", forces=force + np.flip(force, 0))

"""Fits in the 2-norm beside a general semidefinite programme: springs on lengths and on the angles between the edges of every corner."""

from pathlib import Path

import numpy as np
import pytest

import springfit as sf

ELEMENTS = Path(__file__).resolve().parents[2] / "elements"
ANGLES = '\n[[springs]]\ngroup = "angle"\nkind = "angle"\nnodes = "complete"\n'


def with_angles(name):
    return sf.Element.parse((ELEMENTS / f"{name}.toml").read_text() + ANGLES)


def length(x, a, b):
    """The gradient of |x_b - x_a|, (nodes, dimension)."""
    g = np.zeros_like(x)
    g[b] = (x[b] - x[a]) / np.linalg.norm(x[b] - x[a])
    g[a] = -g[b]
    return g


def angle(x, a, b, c):
    """The gradient of the angle at x_b: each arm turns by what is perpendicular to it, away from the other, over its length."""
    g = np.zeros_like(x)
    arms = {a: x[a] - x[b], c: x[c] - x[b]}
    for end, other in ((a, c), (c, a)):
        arm, beside = arms[end], arms[other]
        away = -(beside - (beside @ arm) / (arm @ arm) * arm)
        g[end] = away / np.linalg.norm(away) / np.linalg.norm(arm)
    g[b] = -g[a] - g[c]
    return g


def gradients(element, x):
    """Those of all springs that are not on the content, (springs, nodes*dimension)."""
    lists = [nodes for group, springs in element.springs.items() if group != "bulk" for nodes in springs]
    return np.array([(length if len(nodes) == 2 else angle)(x, *nodes).ravel() for nodes in lists])


def optimum(cvxpy, r, g):
    """``min ‖R − Σ k_s g_s g_sᵀ‖₂`` over the deformations, on which R is definite."""
    values, vectors = np.linalg.eigh(r)
    kept = values > 1e-9 * values[-1]
    size, basis = values[-1], vectors[:, kept]
    along = (g / np.linalg.norm(g, axis=1, keepdims=True)) @ basis
    k, t = cvxpy.Variable(len(g)), cvxpy.Variable()
    order = kept.sum()
    outers = np.einsum("si,sj->ijs", along, along).reshape(order * order, -1)
    rest = np.diag(values[kept] / size) - cvxpy.reshape(outers @ k, (order, order), order="C")
    unit = np.eye(order)
    problem = cvxpy.Problem(cvxpy.Minimize(t), [t * unit - rest >> 0, t * unit + rest >> 0])
    return size * problem.solve(solver=cvxpy.CLARABEL)


SMALL = ["tri3", "quad4", "pentagon5", "tri6", "tet4", "pyramid5", "wedge6", "hex8"]
CASES = [(name, poisson) for name in SMALL for poisson in (0.0, 0.3, 0.49)]
# 214 springs and two matrices of order 54: a minute of the general solver.
LARGE = [pytest.param("hex20", 0.3, marks=pytest.mark.long)]


@pytest.mark.parametrize("name, poisson", CASES + LARGE)
def test_spectral_fits_with_springs_on_angles_are_the_optimum_of_cvxpy(name, poisson):
    """The optima agree to 1e-6 of R, where the general solver ends; K is made of the constants in their unit, N m for angles."""
    cvxpy = pytest.importorskip("cvxpy")
    element = with_angles(name)
    rng = np.random.default_rng(2026)
    d = element.dimension
    positions = np.reshape(element.positions, (-1, d))
    x = 0.01 * (positions @ (np.eye(d) + 0.2 * rng.uniform(-1, 1, (d, d))) + 0.05 * rng.uniform(-1, 1, positions.shape))
    mesh = sf.Mesh(x, [(element, [np.arange(len(x))])])
    material = sf.Material(young=1e4, poisson=poisson, plane="stress" if d == 2 else None)
    r = sf.stiffness(mesh, material).toarray()
    net = sf.fit(mesh, material, "spectral")
    k = net.stiffness().toarray()
    size = np.linalg.norm(r, 2)
    own = np.linalg.norm(r - k, 2)
    g = gradients(element, x)
    assert abs(own - optimum(cvxpy, r, g)) <= 1e-6 * size
    # K is that of these gradients with the constants of the network: N/m of lengths, N m of angles.
    found = {frozenset(pair): value for pair, value in zip(net.springs.tolist(), net.constants)}
    for group in net.contents:
        found |= {(frozenset(nodes[::2]), nodes[1]): value for nodes, value in zip(group["points"].tolist(), group["constants"])}
    lists = [nodes for group, springs in element.springs.items() if group != "bulk" for nodes in springs]
    own = [found[frozenset(nodes) if len(nodes) == 2 else (frozenset(nodes[::2]), nodes[1])] for nodes in lists]
    assert np.abs((g.T * own) @ g - k).max() <= 1e-9 * size

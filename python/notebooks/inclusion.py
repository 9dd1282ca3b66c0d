# %% [markdown]
# # A stiff inclusion, from the surface
#
# A square is soft, but for a stiff disc in it. It is held at the bottom, six tractions act on its sides one after the other, and displacements are
# measured on these sides alone, with noise of one percent. Where is the disc, and how stiff is it?

# %%
import matplotlib.pyplot as plt
import numpy as np
import scipy.sparse.linalg
import skfem
import springfit as sf
from skfem.models.elasticity import lame_parameters, linear_elasticity

# %% [markdown]
# ## The measurements
#
# They come from another program, another mesh and another element: quadratic quadrilaterals of scikit-fem, finer than the mesh below.

# %%
SIDES = {"left": lambda x: np.isclose(x[0], 0), "right": lambda x: np.isclose(x[0], 1), "top": lambda x: np.isclose(x[1], 1)}
LOADS = {
    "pull": ("top", [0, 100]), "shear": ("top", [50, 0]),
    "right pull": ("right", [100, 0]), "right shear": ("right", [0, 50]),
    "left pull": ("left", [-100, 0]), "left shear": ("left", [0, 50]),
}
disc = lambda x, y: (x - 0.6) ** 2 + (y - 0.55) ** 2 < 0.2**2
element = skfem.ElementVector(skfem.ElementQuad2())
grid = skfem.MeshQuad.init_tensor(np.linspace(0, 1, 37), np.linspace(0, 1, 37))
basis = skfem.Basis(grid, element)
inside = disc(*grid.p[:, grid.t].mean(axis=1))
stiffness = 0
for young, cells in [(1e4, ~inside), (5e4, inside)]:
    own = skfem.Basis(grid, element, elements=np.flatnonzero(cells))
    stiffness = stiffness + skfem.asm(linear_elasticity(*lame_parameters(young, 0.3)), own)
free = np.setdiff1d(np.arange(basis.N), basis.get_dofs(lambda x: np.isclose(x[1], 0)).all())
factor = scipy.sparse.linalg.splu(stiffness[free][:, free].tocsc())

# %%
rng = np.random.default_rng(0)
s = np.linspace(0.02, 0.98, 25)
places = np.concatenate([np.stack([0 * s, s]), np.stack([0 * s + 1, s]), np.stack([s, 0 * s + 1])], axis=1)
probes = basis.probes(places)
measured, noise = {}, {}
for name, (side, traction) in LOADS.items():
    facets = skfem.FacetBasis(grid, element, facets=grid.facets_satisfying(SIDES[side], boundaries_only=True))
    force = skfem.asm(skfem.LinearForm(lambda v, w: traction[0] * v[0] + traction[1] * v[1]), facets)
    u = np.zeros(basis.N)
    u[free] = factor.solve(force[free])
    seen = (probes @ u).reshape(2, -1).T
    noise[name] = 0.01 * np.sqrt(np.mean(seen**2))
    measured[name] = (places.T, seen + noise[name] * rng.normal(size=seen.shape))

# %% [markdown]
# ## Two fields
#
# Each of 392 triangles has a modulus, and 900 numbers were measured. A prior says what they do not: that the field is constant but for jumps, or
# that it is smooth. The weight of both is chosen by the same rule, so that residuals are as large as the noise.

# %%
mesh = sf.Mesh.box("tri3", [1, 1], [14, 14])
groups = {name: on(mesh.points.T) for name, on in SIDES.items()}
mesh = sf.Mesh(mesh.points, mesh.cells, {**groups, "held": mesh.points[:, 1] < 1e-9})
loads = {name: {"group": side, "traction": traction} for name, (side, traction) in LOADS.items()}
guess = sf.Material(1.5e4, 0.3, plane="strain")
found = {
    prior: sf.calibrate(mesh, guess, measured, noise=noise, unknowns="cells", prior=prior, fix=["held"], loads=loads)
    for prior in ["edges", "smooth"]
}

# %% [markdown]
# The truth is known here, so that both can be judged.

# %%
cells = mesh.cells[0][1]
truth = np.where(disc(*mesh.points[cells].mean(axis=1).T), 5e4, 1e4)
for prior, own in found.items():
    correlation = np.corrcoef(truth, own.young)[0, 1]
    error = np.sqrt(np.mean(np.log(own.young / truth) ** 2))
    print(f"{prior}: correlation {correlation:.2f}, error of the logarithm {error:.2f} (rms)")
    assert own.misfit < 1.2

# %%
edges, smooth = (np.corrcoef(truth, found[prior].young)[0, 1] for prior in ["edges", "smooth"])
assert edges > 0.85 and edges > smooth

# %%
# Young's modulus of each cell, kPa: the truth, and what was found with either prior; the circle is the edge of the disc
figure, axes = plt.subplots(1, 3, figsize=(8, 2.8), sharey=True)
angle = np.linspace(0, 2 * np.pi, 100)
for plot, (title, young) in zip(axes, [("truth", truth), *((prior, own.young) for prior, own in found.items())]):
    colours = plot.tripcolor(*mesh.points.T, cells, young / 1e3, vmin=10, vmax=50, rasterized=True)
    plot.plot(0.6 + 0.2 * np.cos(angle), 0.55 + 0.2 * np.sin(angle), "w", lw=1)
    plot.set(title=title, aspect="equal")
    plot.grid(False)
figure.colorbar(colours, ax=axes, label="E, kPa");

# %% [markdown]
# The disc is found where it is. Its modulus is underestimated: displacements of the surface hardly tell a disc of five times the stiffness from one of
# four times, and a prior takes the smaller jump.

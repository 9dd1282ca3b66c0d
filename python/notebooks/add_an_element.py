# %% [markdown]
# # Add an element
#
# An element is a text. Here it is a triangle with a fourth node in its middle, whose shape function is a bubble. springfit has no such
# element. At the end of this page it is fitted, checked against quadrature of our own, and solved.

# %%
import matplotlib.pyplot as plt
import numpy as np
import springfit as sf

# %% [markdown]
# ## The text
#
# Each node has a place in the reference cell and a shape function. Gradients are derived from the expressions. `complete` puts a spring
# between every two nodes, and `auto` sorts them into groups by the symmetry of the cell.

# %%
TRI4 = """
name        = "tri4"
title       = "Triangle with a bubble"
cell        = "triangle"
coordinates = ["xi", "eta"]
let         = { b = "9*xi*eta*(1 - xi - eta)" }
nodes = [
    { at = [0, 0], shape = "1 - xi - eta - b" },
    { at = [1, 0], shape = "xi - b" },
    { at = [0, 1], shape = "eta - b" },
    { at = ["1/3", "1/3"], shape = "3*b" },
]

[quadrature]
rule   = "simplex"
degree = 4

[[springs]]
group = "all"
kind  = "length"
nodes = "complete"
class = "auto"
"""
tri4 = sf.Element.parse(TRI4)
for group, springs in tri4.springs.items():
    print(group, springs)

# %% [markdown]
# The same text in a file, `tri4.toml`, is what the command `springfit check tri4.toml` tests, and what a scene names as the element of
# its mesh.

# %%
from pathlib import Path

Path("tri4.toml").write_text(TRI4)
assert sf.Element("tri4.toml").nodes == 4

# %% [markdown]
# ## A look at the bubble

# %%
# The shape function of the fourth node over the reference triangle
xi, eta = np.meshgrid(np.linspace(0, 1, 61), np.linspace(0, 1, 61))
bubble = np.where(xi + eta <= 1, 27 * xi * eta * (1 - xi - eta), np.nan)
figure, axes = plt.subplots(figsize=(3.6, 3))
filled = axes.contourf(xi, eta, bubble, levels=np.linspace(0, 1, 11), cmap="viridis")
axes.plot(*tri4.positions.T, "ko", clip_on=False)
axes.set(aspect="equal", xlabel="ξ", ylabel="η")
figure.colorbar(filled, label="shape function")
plt.show()

# %% [markdown]
# ## Its stiffness, by our own quadrature
#
# The matrix of one cell is compared with an integral that shares nothing with springfit: polynomials in NumPy, and Duffy's map of Gauss's
# points from the square to the triangle.

# %%
corners = np.array([[0.0, 0.0], [0.03, 0.004], [0.01, 0.02]])
cell = sf.Mesh(np.vstack([corners, corners.mean(0)]), [(tri4, [[0, 1, 2, 3]])])
material = sf.Material(young=10e3, poisson=0.3, plane="strain", thickness=1.0)
ours = sf.stiffness(cell, material).toarray()

lam, mu = 10e3 * 0.3 / (1.3 * 0.4), 10e3 / 2.6
nodes, weights = np.polynomial.legendre.leggauss(6)
s, w = (nodes + 1) / 2, weights / 2
theirs = np.zeros((4, 2, 4, 2))
for a, wa in zip(s, w):
    for b, wb in zip(s, w):
        x, y = a, b * (1 - a)
        db = 9 * np.array([y * (1 - x - y) - x * y, x * (1 - x - y) - x * y])
        reference = np.array([[-1, -1] - db, [1, 0] - db, [0, 1] - db, 3 * db])
        jacobian = cell.points.T @ reference
        g = reference @ np.linalg.inv(jacobian)
        share = wa * wb * (1 - a) * np.linalg.det(jacobian)
        theirs += share * (lam * np.einsum("ai,bj->aibj", g, g) + mu * np.einsum("aj,bi->aibj", g, g)
                           + mu * np.einsum("ak,bk,ij->aibj", g, g, np.eye(2)))
difference = np.abs(ours - theirs.reshape(8, 8)).max() / np.abs(ours).max()
print(f"largest difference {difference:.0e} of the largest entry" if difference > 1e-13 else "equal to rounding")

# %% [markdown]
# The two matrices agree to rounding.

# %%
assert difference < 1e-13

# %% [markdown]
# ## A plate of it
#
# A [scene](../reference/scene.md) has the mesh, the supports, the loads and the fits. The plate is held on the left and pulled on the right.

# %%
scene = {
    "mesh": {"box": {"element": "tri4.toml", "size": [0.04, 0.02], "cells": [8, 4]}},
    "material": {"young": "10 kPa", "poisson": 0.3, "thickness": 0.01},
    "fit": [{"objective": name} for name in ["exact", "frobenius", "spectral", "divergence"]]
    + [{"objective": "exact", "nonnegative": True}],
    "fix": [{"group": "xmin"}],
    "load": [
        {"name": "tension", "group": "xmax", "traction": [100, 0]},
        {"name": "shear", "group": "xmax", "traction": [0, 10]},
    ],
}
report = sf.run(scene)
table = report.loads.pivot(index="fit", columns="load", values="e_rms")
table["status"] = report.fits.set_index("name")["status"]
print(table.round(2))

# %% [markdown]
# `exact` holds for an element that the program has never seen, and here even without negative constants. Springs on lengths alone, each cell
# fitted for itself, are wrong by 40 % and more under tension in every norm. Fit an element of your own to see such things before you simulate
# with it.

# %%
assert table.loc[["exact", "exact k>=0"], ["shear", "tension"]].max().max() < 1e-6
assert table.loc[["frobenius", "spectral", "divergence 0.25"], "tension"].min() > 40

# %%
# The plate under tension, as finite elements and as two networks
mesh = sf.Mesh.box("tri4.toml", size=[0.04, 0.02], cells=[8, 4])
moved = report.displacements["tension"]
scale = 0.003 / np.abs(moved[""]).max()
figure, axes = plt.subplots(figsize=(7, 3))
for name, style in [("", "k."), ("exact k>=0", "C0x"), ("spectral", "C1+")]:
    axes.plot(*(mesh.points + scale * moved[name]).T, style, ms=5, label=name or "finite elements")
axes.set(aspect="equal", xlabel="x, m", ylabel="y, m")
axes.legend(loc="center left", bbox_to_anchor=(1, 0.5))
plt.show()

# %% [markdown]
# [An element of your own](../start/element.md) has the commands that check an element and derive its formulas.

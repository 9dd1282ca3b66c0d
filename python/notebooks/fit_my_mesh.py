# %% [markdown]
# # Fit my mesh
#
# You have a mesh of tetrahedra and want springs that move like the finite elements. At the end of this page a bent bar hangs under its
# own weight, once as finite elements and three times as springs.

# %%
import matplotlib.pyplot as plt
import numpy as np
import springfit as sf

# %% [markdown]
# ## The mesh
#
# A mesh is an array of points in metres and an array of cells. Yours comes from a file, `sf.Mesh.read("organ.msh", scale=1e-3)`, or from
# another package, `sf.Mesh.from_meshio(mesh)`. This one is a straight bar that is bent to a quarter of a circle.

# %%
bar = sf.Mesh.box("tet4", size=[0.12, 0.03, 0.03], cells=[16, 4, 4])
angle = bar.points[:, 0] / 0.12 * np.pi / 2
radius = 0.08 + bar.points[:, 2]
points = np.column_stack([radius * np.sin(angle), bar.points[:, 1], radius * np.cos(angle)])

mesh = sf.Mesh(points, dict(bar.cells), groups={"held": bar.groups["xmin"]})
mesh

# %% [markdown]
# A bad cell spoils a fit, so the quality of the cells is measured when the mesh is made: 0 is flat, and 1 has right angles.

# %%
print(f"worst quality {mesh.quality['worst']:.2f}")

# %% [markdown]
# ## The springs
#
# The density gives each point its mass. The objective `exact`, the default, writes the finite element as springs: lengths between the
# nodes, and the volume of each cell. `offdiag` with `nonnegative` is a classical network, which has springs between two points only.

# %%
material = sf.Material(young=1e6, poisson=0.3, density=1000.0)
nets = {
    "exact": sf.fit(mesh, material),
    "exact, k ≥ 0": sf.fit(mesh, material, nonnegative=True),
    "classical": sf.fit(mesh, material, "offdiag", nonnegative=True),
}
for name, net in nets.items():
    volumes = sum(len(kind["constants"]) for kind in net.contents)
    print(f"{name:13} {len(net.springs)} springs, {volumes} on volumes, the least constant {net.constants.min():8.2f} N/m")

# %% [markdown]
# ## The weight
#
# `solve` gives small displacements with a part held. The finite elements are `sf.stiffness`, a SciPy matrix.

# %%
from scipy.sparse.linalg import spsolve

weight = nets["exact"].masses[:, None] * [0, 0, -9.81]
free = np.ones(points.shape, bool)
free[mesh.groups["held"]] = False
free = np.flatnonzero(free)
u_fem = np.zeros(points.size)
u_fem[free] = spsolve(sf.stiffness(mesh, material)[free][:, free].tocsc(), weight.ravel()[free])
u_fem = u_fem.reshape(points.shape)
largest = np.linalg.norm(u_fem, axis=1).max()

error = {}
for name, net in nets.items():
    u = net.solve(fix="held", forces=weight)
    error[name] = 100 * np.linalg.norm(u - u_fem, axis=1) / largest
    print(f"{name:13} root mean square {np.sqrt((error[name]**2).mean()):6.3f} %, largest {error[name].max():6.3f} %")

# %% [markdown]
# The exact network is the finite element. Without negative constants no point is 4 % off. Points of the classical network are more than 20 %
# off: springs on lengths alone cannot hold Poisson's ratio.

# %%
assert error["exact"].max() < 1e-6
assert error["exact, k ≥ 0"].max() < 4
assert error["classical"].max() > 20

# %%
# The bar from the side, at rest and moved by ten times its displacements, and the errors of its points
figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.2))
side = points[:, 1] == 0
left.plot(*points[side][:, [0, 2]].T, ".", color="0.75", ms=3, label="at rest")
left.plot(*(points + 10 * u_fem)[side][:, [0, 2]].T, ".", color="C0", ms=3, label="under its weight, × 10")
left.set(aspect="equal", xlabel="x, m", ylabel="z, m")
left.legend(fontsize=8, loc="lower center", bbox_to_anchor=(0.5, 1))
for name, values in error.items():
    if name != "exact":
        right.plot(np.sort(values), np.linspace(0, 100, len(values)), label=name)
right.set(xlabel="distance from the finite elements, %", ylabel="points within, %")
right.legend()
plt.show()

# %% [markdown]
# ## Take it with you
#
# The network file holds all that a program needs to move the network. [Outputs](../reference/outputs.md) has its keys, and
# [How to choose](../choose.md) says which objective fits which purpose.

# %%
nets["exact, k ≥ 0"].write("springs.json")

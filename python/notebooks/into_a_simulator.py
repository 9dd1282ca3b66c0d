# %% [markdown]
# # Into a simulator
#
# A network of springs is useful where a simulator has springs and no finite elements of your kind. Here a soft finger is fitted, exported to
# MuJoCo, and swings under its weight. It requires `pip install mujoco`.

# %%
import importlib.util
import subprocess

import matplotlib.pyplot as plt
import mujoco
import numpy as np
import springfit as sf

# %% [markdown]
# ## The body
#
# A bar of tetrahedra, 10 cm long and 2 cm thick, is held at one end. Gravity acts across it.

# %%
scene = """
[mesh]
box = { element = "tet4", size = [0.1, 0.02, 0.02], cells = [10, 2, 2] }

[material]
young   = "200 kPa"
poisson = 0.3
density = 1000

[[fit]]
objective = "exact"

[[fit]]
name        = "classical"
objective   = "offdiag"
nonnegative = true

[[fix]]
group = "xmin"

[[load]]
name = "weight"
body = [0, 0, -9810]    # N/m3, density times gravity
"""
with open("finger.toml", "w") as file:
    file.write(scene)
report = sf.run("finger.toml", out="finger")
mesh = sf.Mesh.box("tet4", size=[0.1, 0.02, 0.02], cells=[10, 2, 2])
u = report.displacements["weight"]
tip = np.flatnonzero(mesh.points[:, 0] > 0.0999)
sag = {name: -1e3 * field[tip, 2].mean() for name, field in u.items()}
for name, value in sag.items():
    print(f"{name or 'finite elements':16} the tip sags by {value:.2f} mm")

# %% [markdown]
# ## Export
#
# The command `springfit export` writes a folder with the network as arrays, `network.npz`, and a script, `run.py`, whose function `model()`
# makes an `MjModel`. The springs are the stiffness of a flex of tetrahedra.

# %%
for fit in ["exact", "classical"]:
    subprocess.run(["springfit", "export", f"finger/{fit}.json", "--to", "mujoco", "--out", fit, "-q"], check=True, capture_output=True)


def exported(fit):
    """The module run.py of an exported network."""
    spec = importlib.util.spec_from_file_location(f"run_{fit}", f"{fit}/run.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


modules = {fit: exported(fit) for fit in ["exact", "classical"]}

# %% [markdown]
# ## Let it go
#
# The bar is released at rest. The loop is that of any MuJoCo program.

# %%
seconds = 0.6
times, paths = None, {}
for fit, module in modules.items():
    model = module.model()
    data = mujoco.MjData(model)
    path = []
    for _ in range(round(seconds / model.opt.timestep)):
        mujoco.mj_step(model, data)
        path.append(data.flexvert_xpos[tip, 2].mean() - mesh.points[tip, 2].mean())
    times = model.opt.timestep * np.arange(1, len(path) + 1)
    paths[fit] = -1e3 * np.array(path)
    print(f"{fit:10} deepest {paths[fit].max():.2f} mm")

# %%
# How far the tip of the bar hangs down, by time
figure, axes = plt.subplots()
for fit, color in [("exact", "C0"), ("classical", "C1")]:
    axes.plot(times, paths[fit], color, label=f"{fit}, in MuJoCo")
    axes.axhline(sag[fit], color=color, ls=":", label=f"{fit}, at rest")
axes.set(xlabel="time, s", ylabel="sag of the tip, mm")
axes.invert_yaxis()
axes.legend(loc="center left", bbox_to_anchor=(1, 0.5))
plt.show()

# %% [markdown]
# ## Where it comes to rest
#
# `come_to_rest` damps the motion. The equilibrium in MuJoCo is compared with that of the finite elements.

# %%
rest = {}
for fit, module in modules.items():
    moved = module.come_to_rest() - mesh.points
    rest[fit] = -1e3 * moved[tip, 2].mean()
    print(f"{fit:10} {rest[fit]:.2f} mm in MuJoCo, {sag['']:.2f} mm with finite elements")

# %% [markdown]
# In MuJoCo the exact network hangs within 2 % of the finite elements. They are linear, and the tip sags by about a tenth of the length; MuJoCo's
# energy is that of the network for small deformations. The classical network has an error of its own and is more than 2.5 % off. The bar that
# is let go swings to between 1.7 times and twice its sag. A body without losses would go on; the implicit steps of MuJoCo take energy.

# %%
assert abs(rest["exact"] / sag[""] - 1) < 0.02
assert abs(rest["classical"] / sag[""] - 1) > 0.025
assert all(1.7 < paths[fit].max() / sag[fit] < 2 for fit in paths)

# %% [markdown]
# [A mesh that moves in MuJoCo](../start/mujoco.md) is the same without Python, and [Networks in other programs](../reference/exports.md) has the
# other simulators.

"""Bodies at rest in MuJoCo, as flexes, and as spatial tendons between the points."""
import mujoco
import numpy as np

from at_rest import come_to_rest
from script import load  # noqa: F401, run.py calls it

version = mujoco.__version__
told = set()
# Without this, MuJoCo writes warnings into a file in the working directory.
mujoco.set_mju_user_warning(lambda words: told.add(" ".join(words.split())))
solvers = {"discrete": ["exact", "classical"], "tendons 0.1 ms": ["length"]}
own_elements = ["discrete"]
TENDON_STEP = 1e-4  # s; tendons are explicit, and at 1 ms the motion diverges


def warnings():
    """What MuJoCo has warned of since the last call."""
    found = sorted(told)
    told.clear()
    return found


def rest(script, solver_name, forces, slowest, material):
    """Positions at rest; None if it is not reached."""
    if solver_name.startswith("tendons"):
        return rest_of_tendons(script, forces, slowest)
    model = script.model(material)
    data = mujoco.MjData(model)
    bodies = model.flex_vertbodyid
    free = bodies > 0
    data.xfrc_applied[bodies[free], :3] = forces[free]

    def advance(steps, factor):
        for _ in range(steps):
            mujoco.mj_step(model, data)
            data.qvel[:] *= factor

    def positions():
        mujoco.mj_forward(model, data)
        return script.positions(model, data)

    return come_to_rest(advance, positions, slowest, script.step)


def with_tendons(script):
    """A model of point masses on three slides each, joined by tendons of the constants and rest lengths of the springs."""
    spec = mujoco.MjSpec()
    spec.option.timestep, spec.option.gravity = TENDON_STEP, [0, 0, 0]
    held = set(script.net["fixed"].tolist())
    for p, (x, mass) in enumerate(zip(script.points, script.masses)):
        body = spec.worldbody
        if p not in held:
            body = spec.worldbody.add_body(pos=x, mass=mass, inertia=[1e-12] * 3, explicitinertial=True)
            for axis in np.eye(3):
                body.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis)
        body.add_site(name=f"p{p}", pos=x if p in held else [0, 0, 0])
    for (i, j), k, rest in zip(script.springs, script.k, script.rest):
        tendon = spec.add_tendon(stiffness=k, springlength=[rest, rest])
        tendon.wrap_site(f"p{i}")
        tendon.wrap_site(f"p{j}")
    return spec.compile(), np.array([p for p in range(len(script.points)) if p not in held])


def rest_of_tendons(script, forces, slowest):
    model, free = with_tendons(script)
    data = mujoco.MjData(model)
    data.xfrc_applied[1:, :3] = forces[free]

    def advance(steps, factor):
        for _ in range(steps):
            mujoco.mj_step(model, data)
            data.qvel[:] *= factor

    def positions():
        x = script.points.copy()
        x[free] += data.qpos.reshape(-1, 3)
        return x

    return come_to_rest(advance, positions, slowest, TENDON_STEP)


def same_at_small_strain(solver_name, young, poisson):
    """Nothing: the law is that of St. Venant and Kirchhoff with the moduli that are told."""
    return None

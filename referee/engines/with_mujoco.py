"""Bodies at rest in MuJoCo, as flexes."""
import mujoco
import numpy as np

from at_rest import come_to_rest

version = mujoco.__version__
told = set()
# Without this, MuJoCo writes warnings into a file in the working directory.
mujoco.set_mju_user_warning(lambda words: told.add(" ".join(words.split())))
solvers = {"discrete": ["exact", "classical"]}


def warnings():
    """What MuJoCo has warned of since the last call."""
    found = sorted(told)
    told.clear()
    return found


def rest(script, solver_name, forces, slowest, material):
    """Positions at rest; None if it is not reached."""
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


def same_at_small_strain(solver_name, young, poisson):
    """Nothing: the law is that of St. Venant and Kirchhoff with the moduli that are told."""
    return None

"""Bodies in MuJoCo: a flex of springs or of its own elements, or spatial tendons between the points."""
import math

import mujoco
import numpy as np

version = mujoco.__version__
told = set()
# Without this, MuJoCo writes warnings into a file in the working directory.
mujoco.set_mju_user_warning(lambda words: told.add(" ".join(words.split())))
TENDON_STEP = 1e-4  # s; tendons are explicit, and at 1 ms the motion diverges


def Body(script, solver, told, damping):
    return Tendons(script, damping) if solver.startswith("tendons") else Flex(script, told, damping)


class Model:
    """A model whose velocities are damped after each step."""

    def __init__(self, model, step, damping):
        self.model, self.step, self.factor = model, step, math.exp(-damping * step)
        self.data = None

    def load(self, forces):
        self.data = mujoco.MjData(self.model)
        self.pull(forces)

    def advance(self, steps):
        for _ in range(steps):
            mujoco.mj_step(self.model, self.data)
            self.data.qvel[:] *= self.factor

    def warnings(self):
        found = sorted(told)
        told.clear()
        return found


class Flex(Model):
    def __init__(self, script, material, damping):
        super().__init__(script.model(material), script.step, damping)
        self.script = script

    def pull(self, forces):
        bodies = self.model.flex_vertbodyid
        free = bodies > 0
        self.data.xfrc_applied[bodies[free], :3] = forces[free]

    def positions(self):
        mujoco.mj_forward(self.model, self.data)
        return self.script.positions(self.model, self.data)


class Tendons(Model):
    """Point masses on three slides each, joined by tendons of the constants and rest lengths of the springs."""

    def __init__(self, script, damping):
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
        super().__init__(spec.compile(), TENDON_STEP, damping)
        self.points, self.free = script.points, np.array([p for p in range(len(script.points)) if p not in held])

    def pull(self, forces):
        self.data.xfrc_applied[1:, :3] = forces[self.free]

    def positions(self):
        x = self.points.copy()
        x[self.free] += self.data.qpos.reshape(-1, 3)
        return x

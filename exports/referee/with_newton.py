"""Bodies in Newton, by its solvers SemiImplicit, VBD and XPBD."""
import math

import newton
import numpy as np
import warp as wp

version = newton.__version__
# Step in s and iterations. A step of VBD starts from where the points would fly, and what its iterations leave of that is there at rest too.
# XPBD runs away with steps of 0.5 ms and more.
ITERATED = {"VBD 1 ms": (1e-3, 20), "VBD 2 ms": (2e-3, 20), "VBD 10 substeps": (1 / 600, 10), "XPBD 0.2 ms": (2e-4, 2)}


class Body:
    def __init__(self, script, solver, told, damping):
        builder = script.build(told)
        # Networks that are fitted for VBD have colours of their own.
        if solver.startswith("VBD") and not builder.particle_color_groups:
            builder.color()
        self.model = builder.finalize()
        if solver == "SemiImplicit":
            # Stiffer moduli need a shorter step; the ones told are at most twice as stiff.
            self.step, self.solver = 0.7 * script.step, newton.solvers.SolverSemiImplicit(self.model)
        else:
            self.step, iterations = ITERATED[solver]
            kind = newton.solvers.SolverVBD if solver.startswith("VBD") else newton.solvers.SolverXPBD
            self.solver = kind(self.model, iterations=iterations)
        self.factor = np.float32(math.exp(-damping * self.step))
        self.control = self.model.control()

    def load(self, forces):
        self.states = [self.model.state(), self.model.state()]
        self.forces = wp.array(forces.astype(np.float32), dtype=wp.vec3)

    def advance(self, steps):
        for _ in range(steps):
            now, after = self.states
            now.clear_forces()
            wp.copy(now.particle_f, self.forces)
            self.solver.step(now, after, self.control, None, self.step)
            after.particle_qd.numpy()[:] *= self.factor  # on a processor the array itself
            self.states.reverse()

    def positions(self):
        return self.states[0].particle_q.numpy().astype(float)

    def warnings(self):
        """None: what Newton warns of goes to the terminal."""
        return []

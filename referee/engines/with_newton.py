"""Bodies at rest in Newton, by its solvers SemiImplicit and VBD."""
import newton
import numpy as np
import warp as wp

from at_rest import come_to_rest
from script import load  # noqa: F401, run.py calls it

version = newton.__version__
# The solvers, and the networks of springs in each. XPBD is left out: it takes no springs with k <= 0 and no tetrahedra without shear
# modulus, which volume springs are; its own elements and springs on lengths were not at rest within minutes.
solvers = {"SemiImplicit": ["exact", "classical"], "VBD 1 ms": ["exact"], "VBD 2 ms": []}
own_elements = ["SemiImplicit", "VBD 1 ms", "VBD 2 ms"]
# Step in s and iterations. A step of VBD starts from where the points would fly, and what its iterations leave of that is there at rest too.
IMPLICIT = {"VBD 1 ms": (1e-3, 20), "VBD 2 ms": (2e-3, 20)}


def warnings():
    """Nothing: what Newton warns of goes to the terminal."""
    return []


def rest(script, solver_name, forces, slowest, material):
    """Positions at rest; None if it is not reached."""
    builder = script.build(material)
    if solver_name in IMPLICIT:
        builder.color()
    model = builder.finalize()
    if solver_name == "SemiImplicit":
        # Stiffer moduli need a shorter step; the ones told are at most twice as stiff.
        step, solver = 0.7 * script.step, newton.solvers.SolverSemiImplicit(model)
    else:
        step, iterations = IMPLICIT[solver_name]
        solver = newton.solvers.SolverVBD(model, iterations=iterations)
    states = [model.state(), model.state()]
    control = model.control()
    pull = wp.array(forces.astype(np.float32), dtype=wp.vec3)

    def advance(steps, factor):
        for _ in range(steps):
            now, after = states
            now.clear_forces()
            wp.copy(now.particle_f, pull)
            solver.step(now, after, control, None, step)
            after.particle_qd.numpy()[:] *= np.float32(factor)  # on a processor the array itself
            states.reverse()

    return come_to_rest(advance, lambda: states[0].particle_q.numpy().astype(float), slowest, step)


def same_at_small_strain(solver_name, young, poisson):
    """What E and nu to tell so that the law has E and nu at small strains, where the law is known to differ.

    SemiImplicit has the stress `P = mu (1 - 1/(I + 1)) F + lambda (J - alpha) dJ/dF` with `alpha = 1 + 3 mu/(4 lambda)`, from Smith,
    De Goes and Kim (2018), and puts in Lame's parameters as they are. Its moduli at rest are `3/4 mu` and `lambda - 5/8 mu`.
    """
    if solver_name != "SemiImplicit":
        return None
    mu, lam = young / (2 + 2 * poisson), young * poisson / ((1 + poisson) * (1 - 2 * poisson))
    told_mu, told_lam = 4 / 3 * mu, lam + 5 / 6 * mu
    return told_mu * (3 * told_lam + 2 * told_mu) / (told_lam + told_mu), told_lam / (2 * (told_lam + told_mu))

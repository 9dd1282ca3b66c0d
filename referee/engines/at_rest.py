"""When a body is at rest: the motion is damped near the critical damping of its slowest oscillation until nothing moves."""
import math

import numpy as np

# After the time T the slowest oscillation has fallen to exp(-w T): 6e-6.
DECAYS = 12.0
# It is at rest if nothing has moved by more than this, of the largest displacement, in the last fifth of the time.
STILL = 3e-4


def come_to_rest(advance, positions, slowest, step):
    """Positions at rest. `advance(steps, factor)` makes steps after each of which all velocities are multiplied by the factor."""
    start = positions()
    factor = math.exp(-2 * slowest * step)
    steps = max(math.ceil(DECAYS / (slowest * step)), 20)
    advance(steps - steps // 5, factor)
    for _ in range(12):
        before = positions()
        advance(max(steps // 5, 1), factor)
        after = positions()
        if not np.all(np.isfinite(after)):
            return None
        if np.abs(after - before).max() <= STILL * np.abs(after - start).max():
            return after
        steps = math.ceil(1.25 * steps)
    return None

"""The gradient of spring constants beside the constants themselves, in processor time of one run: python gradients.py [--runs 5] [--cells 40]."""

import argparse
import time

import numpy as np
import springfit as sf

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("--runs", type=int, default=5, help="of each; the least time counts")
parser.add_argument("--cells", type=int, default=40, help="along each side of a cube of tetrahedra; of hexahedra half as many")
options = parser.parse_args()


def least(work):
    times = []
    for _ in range(options.runs):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times)


print(f"{'':24}{'cells':>9}{'build':>9}{'values':>9}{'gradient':>9}{'along':>9}{'ratio':>7}")
for name, objectives in (("tet4", ["exact", "offdiag", "frobenius"]), ("hex8", ["exact", "offdiag", "frobenius", "modal"])):
    side = options.cells if name == "tet4" else options.cells // 2
    mesh = sf.Mesh.box(name, size=[1, 1, 1], cells=[side] * 3)
    rng = np.random.default_rng(1)
    points = mesh.points + 0.1 / side * rng.uniform(-1, 1, mesh.points.shape)
    count = sum(len(cells) for _, cells in mesh.cells.items())
    young, poisson = 1e4 * rng.uniform(0.5, 2, count), rng.uniform(0.1, 0.4, count)
    for objective in objectives:
        start = time.process_time()
        constants = sf.SpringConstants(mesh.cells, objective)
        build = time.process_time() - start
        values = constants(points, young, poisson)
        weights = dict(zip(["weights", "contents", "rest", "rest_contents"], (rng.normal(size=own.shape) for own in values)))
        own = least(lambda: constants(points, young, poisson))
        gradient = least(lambda: constants.gradient(points, young, poisson, **weights))
        along = least(lambda: constants.along(points, young, poisson, changes=(points, young, poisson)))
        print(f"{name + ' ' + objective:24}{count:9}{build:9.3f}{own:9.3f}{gradient:9.3f}{along:9.3f}{gradient / own:7.1f}")

"""Frobenius fit of many tetrahedra, batched in NumPy: the same arithmetic as springfit's, for comparison.

Usage: numpy_tet4.py NODES, a file of float64, [elements, 4, 3]. Prints seconds, then the sum of all constants.
"""

import sys
import time

import numpy as np

LAMBDA, MU = 1e4 * 0.3 / (1.3 * 0.4), 1e4 / 2.6
PAIRS = np.array([[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]])
# g_s · g_t = (n_s · n_t) times the number of shared ends of equal sign less those of unequal sign.
ENDS = np.array([[int(a == c) + int(b == d) - int(a == d) - int(b == c) for c, d in PAIRS] for a, b in PAIRS])


def fit(x):
    edges = (x[:, 1:] - x[:, :1]).transpose(0, 2, 1)
    inverse = np.linalg.inv(edges)
    volume = np.abs(np.linalg.det(edges)) / 6
    gradients = np.concatenate([-inverse.sum(1, keepdims=True), inverse], 1)
    n = x[:, PAIRS[:, 1]] - x[:, PAIRS[:, 0]]
    n /= np.sqrt(np.einsum("esk,esk->es", n, n))[..., None]
    w = gradients[:, PAIRS[:, 1]] - gradients[:, PAIRS[:, 0]]
    along, across = np.einsum("esk,esk->es", n, w), np.einsum("esk,esk->es", w, w)
    b = volume[:, None] * ((LAMBDA + MU) * along**2 + MU * across)
    gram = ((n @ n.transpose(0, 2, 1)) * ENDS) ** 2
    return np.linalg.solve(gram, b[..., None])[..., 0]


nodes = np.fromfile(sys.argv[1]).reshape(-1, 4, 3)
best, total = np.inf, 0.0
for _ in range(3):
    start = time.perf_counter()
    # Chunks that stay in the cache are faster than one batch of all.
    total = sum(fit(nodes[i : i + 10_000]).sum() for i in range(0, len(nodes), 10_000))
    best = min(best, time.perf_counter() - start)
print(best, total)

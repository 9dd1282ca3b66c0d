"""Springs for a stiffness matrix from elsewhere."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import _core
from ._arguments import failure, matrix, shown


@dataclass(frozen=True)
class MatrixFit:
    """Springs of a stiffness matrix.

    Attributes:
        springs: Their ends, [springs, 2].
        constants: N/m, [springs].
        rest: Their lengths, m, [springs]: they do not pull at rest.
        frobenius: ‖R − K‖/‖R‖ in the Frobenius norm.
        spectral: ‖R − K‖/‖R‖ in the induced 2-norm.
        is_unique: Whether no other constants reach the same value.
        reached: Whether the search has reached its accuracy.
        gap: The proved gap of a spectral fit, relative to its value; None of others.
        condensed: The number of rows that were condensed.
    """

    springs: np.ndarray
    constants: np.ndarray
    rest: np.ndarray
    frobenius: float
    spectral: float
    is_unique: bool
    reached: bool
    gap: "float | None"
    condensed: int


def fit_matrix(
    stiffness: Any,
    points: Any,
    springs: Any = None,
    *,
    displacements: Any = None,
    objective: str = "frobenius",
    weight: "str | None" = None,
    nonnegative: bool = False,
) -> MatrixFit:
    """Fits springs to a stiffness matrix R: that of a shell, of an element of displacements and pressures, of a condensed superelement.

    The constants k minimise ‖R − Σ_s k_s g_s g_sᵀ‖ as those of an element do. R is proved to be symmetric, and to have no forces under rigid
    motions, before.

    >>> import numpy as np, springfit as sf
    >>> mesh = sf.Mesh.box("hex8", size=[1, 1, 1], cells=[1, 1, 1])
    >>> R = sf.stiffness(mesh, sf.Material(young=1e4, poisson=0.3))
    >>> found = sf.fit_matrix(R, mesh.points)
    >>> len(found.constants), round(found.frobenius, 6)
    (28, 0.330061)

    Args:
        stiffness: R, an array [rows, rows] or a sparse matrix of SciPy, N/m; or the path of a file of Matrix Market.
        points: Positions [points, dimension], m.
        springs: Pairs of points, [springs, 2]; all pairs without it.
        displacements: The row of R of each displacement, [points, dimension]; point · dimension + axis without it. All other rows are
            condensed, R_uu − R_uo R_oo⁻¹ R_ou, because no force acts on them: rotations, pressures, inner points.
        objective: "frobenius", "offdiag", "modal", "spectral" or "divergence".
        weight: "none", "modal" or "relative", of "frobenius" and "spectral".
        nonnegative: Whether no constant may be negative.

    Raises:
        SpringfitError: A shape or a number is wrong; R is not symmetric (key "symmetry") or has forces under a rigid motion (key "rigid
            motions"); what is condensed has no stiffness of its own.
    """
    if isinstance(stiffness, (str, os.PathLike)):
        whole = _core.read_matrix(os.fspath(stiffness))
    else:
        whole = matrix("stiffness", stiffness.toarray() if hasattr(stiffness, "toarray") else stiffness, np.float64)
    places = matrix("points", points, np.float64)
    if not isinstance(objective, str) or not isinstance(weight, (str, type(None))):
        wrong = objective if not isinstance(objective, str) else weight
        raise failure("objective", "the name of an objective", shown(wrong))
    pairs, constants, frobenius, spectral, is_unique, reached, gap, condensed = _core.fit_stiffness(
        whole,
        places,
        None if springs is None else matrix("springs", springs, np.int64),
        None if displacements is None else matrix("displacements", displacements, np.int64),
        objective,
        weight,
        bool(nonnegative),
    )
    rest = np.linalg.norm(places[pairs[:, 1]] - places[pairs[:, 0]], axis=1)
    return MatrixFit(pairs, constants, rest, frobenius, spectral, is_unique, reached, gap, condensed)

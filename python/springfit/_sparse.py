"""Matrices of SciPy from the rows of the compiled part."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


def csr(rows: tuple) -> "csr_matrix":
    """The matrix of ``data``, ``indices`` and ``indptr``, whose rows are sorted and have no place twice."""
    from scipy.sparse import csr_matrix

    size = len(rows[2]) - 1
    matrix = csr_matrix(rows, shape=(size, size), copy=False)
    matrix.has_canonical_format = True
    return matrix

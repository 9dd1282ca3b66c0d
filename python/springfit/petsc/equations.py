"""The equations of a body or a network on all ranks."""

from __future__ import annotations

from typing import Any

import numpy as np
from petsc4py import PETSc

#: Of the residual of each solution, relative to the forces: what rounding leaves is larger in large bodies.
RESIDUAL = 1e-12
#: A larger residual is no solution, as for the command.
SOLVED = 1e-6
#: Of the iterations between two evaluations of the residual, in the norm of the inverse preconditioner.
REDUCTION = 1e-8
ROUNDS = 4


def assemble(comm: Any, blocks: tuple, numbers: np.ndarray, owned: int, total: int, dimension: int) -> "PETSc.Mat":
    """The matrix of all ranks, rows by ranges of ``owned`` points, of the matrices of their cells."""
    starts, columns, values = blocks
    local = PETSc.Mat().createBAIJ(
        (len(numbers) * dimension,) * 2, dimension, csr=(starts.astype(PETSc.IntType), columns.astype(PETSc.IntType), values),
        comm=PETSc.COMM_SELF,
    )
    places = PETSc.LGMap().create(numbers.astype(PETSc.IntType), bsize=dimension, comm=comm)
    sizes = (owned * dimension, total * dimension)
    matrix = PETSc.Mat().createIS((sizes, sizes), lgmapr=places, lgmapc=places, comm=comm)
    matrix.setISLocalMat(local)
    matrix.assemble()
    # In its place.
    matrix.convert("aij")
    local.destroy()
    matrix.setOption(PETSc.Mat.Option.SYMMETRIC, True)
    return matrix


def vector(matrix: "PETSc.Mat", values: np.ndarray) -> "PETSc.Vec":
    """A vector of the rows of a matrix, from those that this rank owns."""
    vec = matrix.createVecRight()
    vec.setArray(values.ravel())
    return vec


class Equations:
    """``K u = f`` with one support.

    Args:
        matrix: K of all degrees of freedom.
        points: Those that this rank owns, m, (owned, dimension).
        held: Their degrees of freedom that are held, (owned, dimension).
        prescribed: The displacements of what is held, m, (owned, dimension).
        keep: Whether K is needed afterwards. Otherwise it becomes the matrix of these equations.
        body: The equations of the finite elements with the same support, whose levels serve where K is not positive definite.
    """

    def __init__(
        self,
        matrix: "PETSc.Mat",
        points: np.ndarray,
        held: np.ndarray,
        prescribed: np.ndarray,
        keep: bool,
        body: "Equations | None" = None,
    ) -> None:
        self._held, self._body = held, body
        self._given = np.where(held, prescribed, 0.0)
        reaction = matrix * vector(matrix, self._given)
        self._reaction = reaction.getArray().reshape(held.shape).copy()
        first = matrix.getOwnershipRange()[0]
        rows = (first + np.flatnonzero(held.ravel())).astype(PETSc.IntType)
        # In the size of the others, so that it does not widen the spectrum.
        diagonal = matrix.getDiagonal()
        self._scale = diagonal.sum() / diagonal.getSize()
        self._matrix = matrix.copy() if keep else matrix
        self._matrix.zeroRowsColumns(rows, diag=self._scale)
        places = self._matrix.createVecRight()
        places.setBlockSize(points.shape[1])
        places.setArray(points.ravel())
        motions = PETSc.NullSpace().createRigidBody(places)
        self._matrix.setBlockSize(points.shape[1])
        self._matrix.setNearNullSpace(motions)
        self._solver = self._create("cg", self._matrix)
        self._solver.getPC().setType("gamg")
        self._solver.setFromOptions()
        self.indefinite = False

    def _create(self, kind: str, levels: "PETSc.Mat", preconditioner: "PETSc.PC | None" = None) -> "PETSc.KSP":
        solver = PETSc.KSP().create(self._matrix.getComm())
        if preconditioner is not None:
            # Before the operators, which it holds.
            solver.setPC(preconditioner)
        solver.setOperators(self._matrix, levels)
        solver.setType(kind)
        if kind == "cg":
            solver.setNormType(PETSc.KSP.NormType.NATURAL)
        solver.setTolerances(rtol=REDUCTION, atol=0, max_it=2000)
        return solver

    def setup(self) -> None:
        """Builds the levels."""
        self._solver.setUp()

    def solve(self, forces: np.ndarray) -> "tuple[np.ndarray | None, int, float]":
        """Displacements of the points that this rank owns (owned, dimension), iterations, and the residual that is left of the forces.
        None where nothing solves the equations."""
        given = self._given
        u = vector(self._matrix, given)
        rhs = np.where(self._held, self._scale * given, forces - self._reaction)
        b = vector(self._matrix, rhs)
        # Of what can move: held ones are as they must be.
        size = vector(self._matrix, np.where(self._held, 0.0, rhs)).norm()
        step, residual = u.duplicate(), b.duplicate()
        iterations, left, best = 0, np.inf, None
        for _ in range(ROUNDS):
            self._matrix.mult(u, residual)
            residual.aypx(-1.0, b)
            now = residual.norm() / size if size > 0 else 0.0
            if not now < left:
                break
            left, best = now, u.getArray().copy().reshape(given.shape)
            if left <= RESIDUAL:
                break
            iterations += self._step(residual, step)
            u.axpy(1.0, step)
        return (best if left <= SOLVED else None), iterations, left

    def _step(self, residual: "PETSc.Vec", step: "PETSc.Vec") -> int:
        step.set(0.0)
        if not self.indefinite:
            self._solver.solve(residual, step)
            wrong = (PETSc.KSP.ConvergedReason.DIVERGED_INDEFINITE_MAT, PETSc.KSP.ConvergedReason.DIVERGED_INDEFINITE_PC)
            if self._solver.getConvergedReason() not in wrong:
                return self._solver.getIterationNumber()
            self.indefinite = True
            step.set(0.0)
            if self._body is not None:
                # An equilibrium that is not stable, with the levels of the finite elements.
                self._solver = self._create("minres", self._body._matrix, self._body._solver.getPC())
        if self._body is not None:
            self._solver.solve(residual, step)
        return self._solver.getIterationNumber()

    def destroy(self) -> None:
        """Gives the memory back."""
        self._matrix.destroy()
        self._solver.destroy()

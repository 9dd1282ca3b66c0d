//! Least squares under equilibrium, over a subset of the unknowns.

use super::linear::{least_squares, null_space, orthonormal};
use nalgebra::{DMatrix, DVector};

/// `min ‖b − A u‖` under `C u = 0`.
pub struct Problem {
    /// Columns of norm one, or zero.
    pub a: DMatrix<f64>,
    pub b: DVector<f64>,
    /// The forces on the deformations. A zero column belongs to an unknown without a force.
    pub c: DMatrix<f64>,
}

/// An optimum over all unknowns.
pub struct Optimum {
    pub unknowns: DVector<f64>,
    /// The dimension of the space of unknowns in equilibrium.
    pub freedom: usize,
    /// Whether there are other optima.
    pub deficient: bool,
}

impl Problem {
    /// A matrix `B` whose orthonormal columns span the `u` in equilibrium that are zero outside `set`.
    pub fn basis(&self, set: &[usize]) -> DMatrix<f64> {
        let n = self.a.ncols();
        let size = |j: usize| self.c.column(j).norm();
        // Unknowns without a force are in balance by themselves. Their zero columns would spoil the pivots of the others.
        let (pulling, free): (Vec<usize>, Vec<usize>) = set.iter().partition(|&&j| size(j) > 0.0);
        // In terms of the forces f_j = ‖C_j‖ u_j, so that the remainder of the null space is relative to the largest
        // force.
        let mut forces = self.c.select_columns(&pulling);
        forces.column_iter_mut().for_each(|mut column| column /= column.norm());
        let mut balanced = null_space(&forces);
        balanced.row_iter_mut().zip(&pulling).for_each(|(mut row, &j)| row /= size(j));
        // Dividing the rows has made the columns oblique.
        let balanced = orthonormal(balanced);
        let mut basis = DMatrix::zeros(n, free.len() + balanced.ncols());
        free.iter().enumerate().for_each(|(column, &j)| basis[(j, column)] = 1.0);
        for (row, &j) in balanced.row_iter().zip(&pulling) {
            basis.view_mut((j, free.len()), (1, balanced.ncols())).copy_from(&row);
        }
        basis
    }

    /// The optimum over the unknowns of `set`; the others are zero.
    pub fn solve(&self, set: &[usize]) -> Optimum {
        let basis = self.basis(set);
        let (w, deficient) = least_squares(&self.a * &basis, &self.b);
        Optimum { freedom: w.len(), unknowns: basis * w, deficient }
    }

    /// `‖b − A u‖²`.
    pub fn square(&self, u: &DVector<f64>) -> f64 {
        (&self.b - &self.a * u).norm_squared()
    }
}

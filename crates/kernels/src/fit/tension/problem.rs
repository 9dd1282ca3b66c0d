//! Least squares under equilibrium, over some of the unknowns.

use super::linear::{least_squares, null_space, orthonormal};
use nalgebra::{DMatrix, DVector};

/// `min ‖b − A u‖` under `C u = 0`.
pub struct Problem {
    /// Columns of norm one, or of zeros.
    pub a: DMatrix<f64>,
    pub b: DVector<f64>,
    /// Forces on the deformations. A column of zeros belongs to an unknown that does not pull.
    pub c: DMatrix<f64>,
}

/// An optimum over all unknowns.
pub struct Optimum {
    pub unknowns: DVector<f64>,
    /// The dimension of the space in equilibrium.
    pub freedom: usize,
    /// Whether others do as well.
    pub deficient: bool,
}

impl Problem {
    /// `B` with orthonormal columns that span the `u` in equilibrium which are zero outside `set`.
    pub fn basis(&self, set: &[usize]) -> DMatrix<f64> {
        let n = self.a.ncols();
        let size = |j: usize| self.c.column(j).norm();
        let (pulling, free): (Vec<usize>, Vec<usize>) = set.iter().partition(|&&j| size(j) > 0.0);
        // In terms of the forces, f_j = ‖C_j‖ u_j, so that what the null space leaves is relative to the largest of them.
        let mut forces = self.c.select_columns(&pulling);
        forces.column_iter_mut().for_each(|mut column| column /= column.norm());
        let mut balanced = null_space(&forces);
        balanced.row_iter_mut().zip(&pulling).for_each(|(mut row, &j)| row /= size(j));
        let balanced = orthonormal(balanced);
        let mut basis = DMatrix::zeros(n, free.len() + balanced.ncols());
        free.iter().enumerate().for_each(|(column, &j)| basis[(j, column)] = 1.0);
        for (row, &j) in balanced.row_iter().zip(&pulling) {
            basis.view_mut((j, free.len()), (1, balanced.ncols())).copy_from(&row);
        }
        basis
    }

    /// The optimum over the unknowns of `set`, the others being zero.
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

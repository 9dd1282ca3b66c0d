//! Symmetric matrices of a cell seen through a weight, as vectors whose Euclidean norm is the norm of the fit.

use crate::fit::weight::Weight;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::SQRT_2;

/// `A ↦ W A W` on the deformations, or the blocks of A that belong to different nodes.
pub enum View {
    /// `P A Pᵀ`, with P of shape `[deformations × nodes·dimension]`.
    Motions(DMatrix<f64>),
    /// The blocks of nodes with so many coordinates, `nodes·dimension` in all.
    Blocks { dimension: usize, size: usize },
}

impl View {
    /// The view of the cell with nodes at `x`, `[nodes × dimension]`, and the stiffness `r`; `deformations` has an
    /// orthonormal basis as its columns. None if R is needed and is not positive definite.
    pub fn of(
        weight: Weight,
        x: &[f64],
        dimension: usize,
        r: &DMatrix<f64>,
        deformations: &DMatrix<f64>,
    ) -> Option<View> {
        let plain = || deformations.transpose();
        Some(match weight {
            Weight::OffDiagonal => View::Blocks { dimension, size: x.len() },
            Weight::None => View::Motions(plain()),
            // W = h + (1 − h) C Cᵀ, with C an orthonormal basis of the linear motions.
            Weight::Modal(higher) => {
                // Translations are among these motions; the deformations that are seen have none of them.
                let linear = linear_motions(x, dimension).qr().q();
                let h = higher.value();
                let seen = deformations.tr_mul(&linear) * linear.transpose();
                View::Motions(h * plain() + (1.0 - h) * seen)
            }
            // With R = L Lᵀ on the deformations, L⁻¹ and R^(−1/2) differ by a rotation, which does not change the norm.
            Weight::Relative => {
                let factor = (deformations.tr_mul(r) * deformations).cholesky()?;
                View::Motions(factor.l_dirty().solve_lower_triangular(&plain())?)
            }
        })
    }

    /// The number of entries of a vector.
    pub fn rows(&self) -> usize {
        match self {
            View::Motions(p) => p.nrows() * (p.nrows() + 1) / 2,
            // Half of the entries outside the blocks of the diagonal.
            View::Blocks { dimension, size } => size * (size - dimension) / 2,
        }
    }

    /// The vector of `g gᵀ`.
    pub fn of_vector(&self, g: &DVector<f64>) -> DVector<f64> {
        match self {
            View::Motions(p) => {
                let h = p * g;
                self.gathered(|i, j| h[i] * h[j])
            }
            View::Blocks { .. } => self.gathered(|i, j| g[i] * g[j]),
        }
    }

    /// The vector of the matrix with these entries in the rows and columns `dofs`, which may be repeated, and zeros
    /// elsewhere.
    pub fn of_matrix(&self, dofs: &[usize], entries: &DMatrix<f64>) -> DVector<f64> {
        match self {
            View::Motions(p) => {
                let p = p.select_columns(dofs);
                let seen = &p * entries * p.transpose();
                self.gathered(|i, j| seen[(i, j)])
            }
            View::Blocks { size, .. } => {
                let mut whole = DMatrix::zeros(*size, *size);
                for (a, &row) in dofs.iter().enumerate() {
                    for (b, &column) in dofs.iter().enumerate() {
                        whole[(row, column)] += entries[(a, b)];
                    }
                }
                self.gathered(|i, j| whole[(i, j)])
            }
        }
    }

    /// The entries of a symmetric matrix; off-diagonal entries count for both triangles.
    fn gathered(&self, entry: impl Fn(usize, usize) -> f64) -> DVector<f64> {
        let mut rows = Vec::with_capacity(self.rows());
        match self {
            View::Motions(p) => {
                for i in 0..p.nrows() {
                    rows.extend((0..i).map(|j| SQRT_2 * entry(i, j)));
                    rows.push(entry(i, i));
                }
            }
            View::Blocks { dimension, size } => {
                for i in 0..*size {
                    rows.extend((0..i / dimension * dimension).map(|j| SQRT_2 * entry(i, j)));
                }
            }
        }
        DVector::from_vec(rows)
    }
}

/// An orthonormal basis, in columns, of the motions that are not rigid, of a cell with nodes at `x`.
pub fn deformations(x: &[f64], dimension: usize) -> DMatrix<f64> {
    let (d, size) = (dimension, x.len());
    let linear = linear_motions(x, d);
    let planes: Vec<(usize, usize)> = (0..d).flat_map(|l| (0..l).map(move |k| (k, l))).collect();
    let rigid = d + planes.len();
    // Translations and rotations first; the following columns of Q of a square matrix are orthogonal to them.
    let mut motions = DMatrix::zeros(size, size);
    for k in 0..d {
        motions.set_column(k, &linear.column(d * d + k));
    }
    for (column, &(k, l)) in (d..).zip(&planes) {
        motions.set_column(column, &(linear.column(k * d + l) - linear.column(l * d + k)));
    }
    motions.qr().q().columns(rigid, size - rigid).into_owned()
}

/// The motions `u_a = e_k r_al`, with r_a relative to the mean of the nodes, in column `k·d + l`, and then the
/// translations.
fn linear_motions(x: &[f64], dimension: usize) -> DMatrix<f64> {
    let (d, n) = (dimension, x.len() / dimension);
    let mean: Vec<f64> = (0..d).map(|l| x.chunks_exact(d).map(|x| x[l]).sum::<f64>() / n as f64).collect();
    // Positions in units of the spread make motions and translations of about one size, whatever the unit of lengths is.
    let spread = x.iter().enumerate().map(|(i, x)| (x - mean[i % d]).powi(2)).sum::<f64>().sqrt();
    DMatrix::from_fn(n * d, d * (d + 1), |row, column| {
        let (a, k, l) = (row / d, column / d, column % d);
        match column < d * d {
            true if row % d == k => (x[a * d + l] - mean[l]) / spread,
            false if row % d == column - d * d => 1.0,
            _ => 0.0,
        }
    })
}

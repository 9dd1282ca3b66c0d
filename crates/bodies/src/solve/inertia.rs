//! The masses of a model: at its points, or as a matrix.

use crate::error::{Error, Result};
use crate::model::ConsistentMasses;
use nalgebra::DMatrix;

/// The masses of a model.
#[derive(Debug, Clone, Copy)]
pub enum Masses<'a> {
    /// At its points, `[points]`, kg.
    Lumped(&'a [f64]),
    /// The matrix that belongs to the shape functions of its cells.
    Consistent(&'a ConsistentMasses),
}

impl<'a> From<&'a [f64]> for Masses<'a> {
    fn from(masses: &'a [f64]) -> Masses<'a> {
        Masses::Lumped(masses)
    }
}

impl<'a> From<&'a Vec<f64>> for Masses<'a> {
    fn from(masses: &'a Vec<f64>) -> Masses<'a> {
        Masses::Lumped(masses)
    }
}

impl<'a> From<&'a ConsistentMasses> for Masses<'a> {
    fn from(masses: &'a ConsistentMasses) -> Masses<'a> {
        Masses::Consistent(masses)
    }
}

impl Masses<'_> {
    fn points(&self) -> usize {
        match self {
            Masses::Lumped(masses) => masses.len(),
            Masses::Consistent(masses) => masses.point_count(),
        }
    }

    /// The diagonal of the matrix, `[points]`, kg.
    fn diagonal(&self) -> Vec<f64> {
        match self {
            Masses::Lumped(masses) => masses.to_vec(),
            Masses::Consistent(masses) => {
                let mut diagonal = vec![0.0; masses.point_count()];
                for (points, values) in masses.rows() {
                    points.iter().zip(values).for_each(|(&p, value)| diagonal[p] += value * value);
                }
                diagonal
            }
        }
    }
}

/// A matrix G with `M = GᵀG` on the degrees of freedom that may move.
pub(super) struct MassRoot<'a> {
    masses: Masses<'a>,
    free: &'a [usize],
    dimension: usize,
    /// The roots of the diagonal of M, `[free]`: G itself where masses are lumped.
    diagonal: Vec<f64>,
}

impl<'a> MassRoot<'a> {
    /// # Errors
    /// There are fewer masses than points with these degrees of freedom, or a point that may move has no mass.
    pub fn new(masses: Masses<'a>, free: &'a [usize], dimension: usize) -> Result<MassRoot<'a>> {
        if !(1..=3).contains(&dimension) {
            return Err(Error::expected("dimension", "1, 2 or 3", dimension));
        }
        let of_points = masses.diagonal();
        let least = free.iter().max().map_or(0, |dof| dof / dimension + 1);
        if of_points.len() < least {
            return Err(Error::expected("masses", format!("one for each of at least {least} points"), of_points.len()));
        }
        let points = || free.iter().map(|dof| dof / dimension);
        if let Some(p) = points().find(|&p| !(of_points[p] > 0.0 && of_points[p].is_finite())) {
            return Err(Error::expected("masses", format!("a mass above zero at point {p}"), of_points[p]));
        }
        Ok(MassRoot { masses, free, dimension, diagonal: points().map(|p| of_points[p].sqrt()).collect() })
    }

    /// The number of rows of G.
    pub fn rows(&self) -> usize {
        match self.masses {
            Masses::Lumped(_) => self.free.len(),
            Masses::Consistent(masses) => masses.row_count() * self.dimension,
        }
    }

    /// `G X`, `[rows × columns]` of `[free × columns]`.
    pub fn product(&self, x: &DMatrix<f64>) -> DMatrix<f64> {
        let Masses::Consistent(masses) = self.masses else { return self.scaled(x) };
        let d = self.dimension;
        let mut product = DMatrix::zeros(self.rows(), x.ncols());
        for (x, mut product) in x.column_iter().zip(product.column_iter_mut()) {
            let all = self.spread(x.as_slice());
            for (row, (points, values)) in masses.rows().enumerate() {
                for k in 0..d {
                    product[row * d + k] = points.iter().zip(values).map(|(&p, value)| value * all[p * d + k]).sum();
                }
            }
        }
        product
    }

    /// `Gᵀ Y`, `[free × columns]` of `[rows × columns]`.
    pub fn transposed(&self, y: &DMatrix<f64>) -> DMatrix<f64> {
        let Masses::Consistent(masses) = self.masses else { return self.scaled(y) };
        let d = self.dimension;
        let mut product = DMatrix::zeros(self.free.len(), y.ncols());
        for (y, mut product) in y.column_iter().zip(product.column_iter_mut()) {
            let mut all = vec![0.0; masses.point_count() * d];
            for (row, (points, values)) in masses.rows().enumerate() {
                for (&p, value) in points.iter().zip(values) {
                    (0..d).for_each(|k| all[p * d + k] += value * y[row * d + k]);
                }
            }
            product.iter_mut().zip(self.free).for_each(|(x, &dof)| *x = all[dof]);
        }
        product
    }

    /// The shape of unit mass that belongs to the unit eigenvector y of `G K⁻¹ Gᵀ` with the eigenvalue θ: `φ = K⁻¹ Gᵀ y/θ`, which is
    /// `G⁻¹ y` if G has an inverse.
    pub fn shape(
        &self,
        y: &DMatrix<f64>,
        theta: f64,
        solve: impl Fn(&mut [f64]) -> Result<()>,
    ) -> Result<DMatrix<f64>> {
        let mut x = match self.masses {
            Masses::Lumped(_) => {
                return Ok(DMatrix::from_fn(y.nrows(), 1, |i, _| y[i] / self.diagonal[i]));
            }
            Masses::Consistent(_) => self.transposed(y),
        };
        solve(x.as_mut_slice())?;
        Ok(x / theta)
    }

    /// Numbers on all degrees of freedom, `[points · dimension]`, zero where they are held.
    pub fn spread(&self, x: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.masses.points() * self.dimension];
        self.free.iter().zip(x).for_each(|(&dof, &x)| all[dof] = x);
        all
    }

    fn scaled(&self, x: &DMatrix<f64>) -> DMatrix<f64> {
        let mut scaled = x.clone();
        scaled.column_iter_mut().for_each(|mut x| x.iter_mut().zip(&self.diagonal).for_each(|(x, root)| *x *= root));
        scaled
    }
}

//! The masses of a model: at its points, or as a matrix.

use crate::error::{Error, Result};
use crate::model::ConsistentMasses;

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
    pub fn diagonal(&self) -> Vec<f64> {
        match self {
            Masses::Lumped(masses) => masses.to_vec(),
            Masses::Consistent(masses) => {
                let mut diagonal = vec![0.0; masses.point_count()];
                for (points, values) in masses.rows() {
                    // The matrix is a sum of squares `g gᵀ` over its rows g.
                    points.iter().zip(values).for_each(|(&p, value)| diagonal[p] += value * value);
                }
                diagonal
            }
        }
    }

    /// The entries of the matrix with their points, kg; those of one pair are to be added.
    pub fn entries(&self) -> Vec<(usize, usize, f64)> {
        match self {
            Masses::Lumped(masses) => masses.iter().enumerate().map(|(p, mass)| (p, p, *mass)).collect(),
            Masses::Consistent(masses) => masses.pairs(),
        }
    }
}

/// The masses M on the degrees of freedom that may move, with the roots `D = diag(M)^½`. In `y = D x` the product of two motions is
/// `yᵀ W y'`, `W = D⁻¹ M D⁻¹`: the identity where masses are lumped, else near it, whatever the sizes of cells and densities (Wathen,
/// IMA J. Numer. Anal. 7, 1987).
pub(super) struct Inertia<'a> {
    masses: Masses<'a>,
    free: &'a [usize],
    dimension: usize,
    /// The diagonal of D, `[free]`, kg^½.
    roots: Vec<f64>,
}

impl<'a> Inertia<'a> {
    /// # Errors
    /// There are fewer masses than points with these degrees of freedom, or a point that may move has no mass.
    pub fn new(masses: Masses<'a>, free: &'a [usize], dimension: usize) -> Result<Inertia<'a>> {
        if !(1..=3).contains(&dimension) {
            return Err(Error::expected("dimension", "1, 2 or 3", dimension));
        }
        let of_points = masses.diagonal();
        let least = free.iter().max().map_or(0, |dof| dof / dimension + 1);
        // A list of masses may be of more points than those that are free, but not of fewer.
        if of_points.len() < least {
            return Err(Error::expected("masses", format!("one for each of at least {least} points"), of_points.len()));
        }
        let points = || free.iter().map(|dof| dof / dimension);
        if let Some(p) = points().find(|&p| !(of_points[p] > 0.0 && of_points[p].is_finite())) {
            return Err(Error::expected("masses", format!("a mass above zero at point {p}"), of_points[p]));
        }
        Ok(Inertia { masses, free, dimension, roots: points().map(|p| of_points[p].sqrt()).collect() })
    }

    /// The degrees of freedom that may move.
    pub fn size(&self) -> usize {
        self.free.len()
    }

    /// `D X` in place of X, `[free × columns]`, one column after the other; as all below.
    pub fn scale(&self, x: &mut [f64]) {
        // Chunks of no entries are a panic, and a body that is held everywhere has none.
        x.chunks_exact_mut(self.roots.len().max(1))
            .for_each(|x| x.iter_mut().zip(&self.roots).for_each(|(x, d)| *x *= d));
    }

    /// `D⁻¹ Y` in place of Y.
    pub fn unscale(&self, y: &mut [f64]) {
        y.chunks_exact_mut(self.roots.len().max(1))
            .for_each(|y| y.iter_mut().zip(&self.roots).for_each(|(y, d)| *y /= d));
    }

    /// `W Y`; `None` where W is the identity.
    pub fn metric(&self, y: &[f64]) -> Option<Vec<f64>> {
        let Masses::Consistent(masses) = self.masses else { return None };
        let mut product = y.to_vec();
        self.unscale(&mut product);
        self.multiply(masses, &mut product);
        self.unscale(&mut product);
        Some(product)
    }

    /// `M X` in place of X.
    pub fn weigh(&self, x: &mut [f64]) {
        match self.masses {
            // M is D² where masses are lumped.
            Masses::Lumped(_) => (0..2).for_each(|_| self.scale(x)),
            Masses::Consistent(masses) => self.multiply(masses, x),
        }
    }

    fn multiply(&self, masses: &ConsistentMasses, x: &mut [f64]) {
        for x in x.chunks_exact_mut(self.free.len().max(1)) {
            let all = masses.product_of(&self.spread(x), self.dimension);
            x.iter_mut().zip(self.free).for_each(|(x, &dof)| *x = all[dof]);
        }
    }

    /// Numbers on all degrees of freedom, `[points · dimension]`, zero where they are held.
    pub fn spread(&self, x: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.masses.points() * self.dimension];
        self.free.iter().zip(x).for_each(|(&dof, &x)| all[dof] = x);
        all
    }
}

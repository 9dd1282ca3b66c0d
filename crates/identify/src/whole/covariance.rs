//! How well displacements determine the unknowns of a whole-object fit.
//!
//! Theory: page *Whole-object fits* of the book.

use super::displacements::Displacements;
use super::linearized::{LeastSquares, PRODUCT};
use super::student::ninety_five;
use crate::error::{Error, Result};
use crate::springs::{dot, norm};
use nalgebra::{DMatrix, DVector};

/// The unknowns that are tried at most: each takes the solution of every load.
pub const MOST_ESTIMATED: usize = 200;
/// A combination of unknowns that changes the residuals by a smaller share of what others do is not determined. Its
/// square, which the normal equations have, is some fifty roundings.
const UNSEEN: f64 = 1e-7;
/// The share of an undetermined combination from which on an unknown belongs to it.
// A combination has the length of one: of 200 unknowns in equal parts each has 0.07. Smaller shares are those of rounding and of
// unknowns that hardly take part.
const PART: f64 = 0.05;

/// The factor that the 95 % interval of a weak combination of unknowns exceeds on either side.
// It was chosen: a modulus that may be half or twice as large is known by its order of magnitude alone.
pub const WEAK: f64 = 2.0;

/// What the residuals say of the unknowns.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Determination {
    /// The standard deviation of each unknown θ, a logarithm; `None` if the displacements do not determine it.
    pub deviations: Vec<Option<f64>>,
    /// The step of each unknown to the optimum without ρ, by linearisation; zero where the displacements do not determine it. This is how far ρ
    /// holds the unknowns near the start.
    pub shifts: Vec<f64>,
    /// The standard deviation of a residual: the relative error of a displacement, with that of one load as its unit.
    pub residual: f64,
    /// Deviations on either side that hold 95 %: those of a normal distribution where the noise is known, and else of Student's with n − m
    /// degrees of freedom.
    pub reach: f64,
    /// Combinations that the displacements hardly see, or not at all, each by its unknowns: those whose 95 % intervals reach beyond the
    /// factor 2.
    pub weak: Vec<Vec<usize>>,
}

impl Determination {
    /// The deviations at θ, by linearisation: `s² (JᵀJ)⁻¹` with the standard deviation `noise` of a residual for s, or
    /// `s² = Σ r²/(n − m)` where it is not known (Seber and Wild 2003, 2.1.2). They hold if the differences between the displacements are
    /// independent errors of equal size within each load, such as the noise of a measurement; errors of the mesh are not, and are not in
    /// them.
    ///
    /// # Errors
    /// The equations do not fit into memory, the network is unstable at θ, or there are more unknowns than
    /// [`MOST_ESTIMATED`] or than displacements.
    pub fn of(problem: &Displacements, theta: &[f64], noise: Option<f64>) -> Result<Determination> {
        let m = theta.len();
        if m > MOST_ESTIMATED || m != problem.unknowns() {
            return Err(Error::expected("unknowns", format!("at most {MOST_ESTIMATED}, those of the problem"), m));
        }
        let at = problem.at(theta)?.ok_or_else(|| Error::expected("network", "a stable one", "one that is not"))?;
        let column = |p: usize| -> Result<Vec<f64>> {
            let unit: Vec<f64> = (0..m).map(|q| f64::from(u8::from(p == q))).collect();
            Ok(at.forward(&unit, PRODUCT)?.concat())
        };
        let columns = (0..m).map(column).collect::<Result<Vec<_>>>()?;
        Determination::by(&columns, &at.residuals.concat(), problem.observations(), noise)
    }

    /// Computes the deviations from the derivatives of the residuals in each unknown, `[unknowns][residuals]`; `seen` residuals are known.
    ///
    /// # Errors
    /// There are as many unknowns as residuals that are known, or more.
    pub fn by(columns: &[Vec<f64>], residuals: &[f64], seen: usize, noise: Option<f64>) -> Result<Determination> {
        let m = columns.len();
        // With as many unknowns as numbers the residuals vanish, and say nothing of the noise.
        if seen <= m {
            return Err(Error::expected("displacements", format!("more than {m} that are known"), seen));
        }
        // Each unknown lowers the sum of squares by that of one residual on average: this divisor leaves the variance
        // without bias.
        let residual = (dot(residuals, residuals) / (seen - m) as f64).sqrt();
        let size = noise.unwrap_or(residual);
        let reach = ninety_five(noise.is_none().then_some(seen - m));
        let norms: Vec<f64> = columns.iter().map(|column| norm(column)).collect();
        let largest = norms.iter().copied().fold(0.0, f64::max);
        let is_seen = |p: usize| norms[p] > UNSEEN * largest;
        // In units in which every unknown changes the residuals alike.
        let scaled = DMatrix::from_fn(m, m, |p, q| {
            if is_seen(p) && is_seen(q) {
                dot(&columns[p], &columns[q]) / (norms[p] * norms[q])
            } else {
                f64::from(u8::from(p == q))
            }
        });
        let eigen = springfit_numerics::dense::eigen(scaled);
        let pairs = || eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter());
        let deviation = |p: usize| {
            if !is_seen(p) {
                return None;
            }
            let mut variance = 0.0;
            for (value, vector) in pairs() {
                if *value > UNSEEN * UNSEEN {
                    variance += vector[p] * vector[p] / value;
                // Rounding gives every unknown some share of a combination that nothing sees.
                } else if vector[p].abs() > PART {
                    return None;
                }
            }
            Some(size * variance.sqrt() / norms[p])
        };
        let slope = |p: usize, _| if is_seen(p) { dot(&columns[p], residuals) / norms[p] } else { 0.0 };
        let slopes = DVector::from_fn(m, slope);
        let mut shifts = vec![0.0; m];
        // Along what the displacements do not see the step without ρ would be rounding over rounding.
        for (value, vector) in pairs().filter(|(value, _)| **value > UNSEEN * UNSEEN) {
            let along = vector.dot(&slopes) / value;
            (0..m).filter(|&p| is_seen(p)).for_each(|p| shifts[p] -= along * vector[p] / norms[p]);
        }
        let mut weak: Vec<Vec<usize>> = (0..m).filter(|&p| !is_seen(p)).map(|p| vec![p]).collect();
        for (value, vector) in pairs() {
            let own: Vec<usize> = (0..m).filter(|&p| is_seen(p) && vector[p].abs() > PART).collect();
            let width = |p: usize| reach * size * vector[p].abs() / (value.sqrt() * norms[p]);
            // A value that is rounding may be negative, and the width NaN: such a direction is asked for first.
            if own.iter().any(|&p| !(*value > UNSEEN * UNSEEN) || width(p) > WEAK.ln()) {
                weak.push(own);
            }
        }
        Ok(Determination { deviations: (0..m).map(deviation).collect(), shifts, residual, reach, weak })
    }
}

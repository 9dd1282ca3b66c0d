//! Loads whose weights fall with their errors, so that those that the network cannot follow do not decide the fit.
//!
//! Theory: page *Whole-object fits* of the book.

use super::displacements::Displacements;
use super::linearized::{LeastSquares, Linearized};
use super::target::Target;
use crate::error::Result;

/// The residuals of displacements, each load weighed by `e²/(e_l² + e²)`, with its relative error e_l at some θ₀ and the median e of these
/// errors. Weights that are renewed on the way minimise `Σ_l ln(1 + e_l²/e²)`, Cauchy's function of the errors (Holland and Welsch
/// 1977). Firm targets keep their weight.
#[derive(Debug)]
pub struct Balanced<'a> {
    problem: &'a Displacements<'a>,
    /// The roots of the weights, `[loads]`.
    roots: Vec<f64>,
    /// `s_l` of each load, multiplied by its root.
    scales: Vec<Vec<f64>>,
}

impl<'a> Balanced<'a> {
    /// The weights of the errors at `theta`; `None` if the network is not stable there.
    ///
    /// # Errors
    /// The equations do not fit into memory.
    pub fn at_errors(problem: &'a Displacements<'a>, theta: &[f64]) -> Result<Option<Balanced<'a>>> {
        let Some(errors) = problem.errors(theta)? else { return Ok(None) };
        // A mean of logarithms would feel the rounding of loads that are met to the last digit.
        let mut sorted = errors.loads.clone();
        sorted.sort_by(f64::total_cmp);
        let typical = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
        let root = |(e, target): (&f64, &&Target)| {
            // Where half of the loads are met to the last digit no error is typical, and all weights stay.
            if target.is_firm || !(typical > 0.0) { 1.0 } else { typical / e.hypot(typical) }
        };
        let roots: Vec<f64> = errors.loads.iter().zip(&problem.targets).map(root).collect();
        let scaled = |(scales, root): (&Vec<f64>, &f64)| scales.iter().map(|s| root * s).collect();
        let scales = problem.scales.iter().zip(&roots).map(scaled).collect();
        Ok(Some(Balanced { problem, roots, scales }))
    }
}

impl LeastSquares for Balanced<'_> {
    fn unknowns(&self) -> usize {
        self.problem.unknowns()
    }

    fn at(&self, theta: &[f64]) -> Result<Option<Linearized<'_>>> {
        let Some(mut found) = self.problem.at(theta)? else { return Ok(None) };
        // The residuals of frequencies follow those of the loads.
        for (residual, root) in found.residuals.iter_mut().zip(&self.roots) {
            residual.iter_mut().for_each(|r| *r *= root);
        }
        Ok(Some(Linearized { scales: &self.scales, ..found }))
    }
}

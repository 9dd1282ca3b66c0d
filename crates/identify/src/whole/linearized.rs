//! The residuals of a whole-object fit at one point, and products with their Jacobian by solves with one factor.
//!
//! Theory: page *Whole-object fits* of the book.

use super::tangent::Tangent;
use super::unknowns::Unknowns;
use crate::error::Result;

/// A sum of squares that is minimised.
pub trait LeastSquares {
    /// The number of unknowns θ.
    fn unknowns(&self) -> usize;

    /// The residuals at θ; `None` if there are none, for example if the network is unstable.
    ///
    /// # Errors
    /// The equations do not fit into memory.
    fn at(&self, theta: &[f64]) -> Result<Option<Linearized<'_>>>;
}

/// Residual vectors `r_l = s_l ∘ (u_l − ū_l)`, one per load, then one of frequencies, with
/// `∂r_l/∂c_s = −s_l ∘ K⁻¹ F_sl`, where c are the factors on the parts of the model, for example its springs, and F_sl are
/// the forces of part s at factor 1.
#[derive(Debug)]
pub struct Linearized<'a> {
    /// The residual vectors.
    pub residuals: Vec<Vec<f64>>,
    pub(super) theta: Vec<f64>,
    pub(super) unknowns: &'a Unknowns,
    pub(super) tangents: Vec<Tangent>,
    /// s_l of each load, on its degrees of freedom.
    pub(super) scales: &'a [Vec<f64>],
    /// The derivatives of the residuals of frequencies in every factor.
    pub(super) rows: Vec<Vec<f64>>,
}

/// The relative error of gradients and of columns of J where equations are solved by iterations.
// Intervals are computed from these columns and printed with three digits. Searches end at steps of 1e-6 in θ.
pub(super) const PRODUCT: f64 = 1e-5;

impl Linearized<'_> {
    /// The sum of squares `Σ ‖r_l‖²`.
    pub fn square(&self) -> f64 {
        self.residuals.iter().flatten().map(|r| r * r).sum()
    }

    /// The product `J v`, within a relative error where equations are solved by iterations.
    ///
    /// # Errors
    /// Iterations stall.
    pub fn forward(&self, v: &[f64], tolerance: f64) -> Result<Vec<Vec<f64>>> {
        let change = self.unknowns.forward(&self.theta, v);
        let mut all: Vec<Vec<f64>> = self.residuals.iter().map(|_| Vec::new()).collect();
        for tangent in &self.tangents {
            let moves = tangent.moves(&change, tolerance)?;
            for (load, mut u) in tangent.loads().zip(moves) {
                u.iter_mut().zip(&self.scales[load]).for_each(|(u, s)| *u *= s);
                all[load] = u;
            }
        }
        // Frequencies come last among the residuals; their derivatives are stored, because each took a mode and no
        // solution.
        if let Some(last) = all.last_mut().filter(|_| !self.rows.is_empty()) {
            *last = self.rows.iter().map(|row| row.iter().zip(&change).map(|(a, c)| a * c).sum()).collect();
        }
        Ok(all)
    }

    /// The product `Jᵀ w`, by one adjoint solve per load, within a relative error where equations are solved by iterations.
    ///
    /// # Errors
    /// Iterations stall.
    pub fn adjoint(&self, w: &[Vec<f64>], tolerance: f64) -> Result<Vec<f64>> {
        let mut total = vec![0.0; self.unknowns.springs()];
        for tangent in &self.tangents {
            let pull = |load: usize| w[load].iter().zip(&self.scales[load]).map(|(w, s)| w * s).collect();
            let pulls: Vec<Vec<f64>> = tangent.loads().map(pull).collect();
            total.iter_mut().zip(tangent.pulled(&pulls, tolerance)?).for_each(|(t, own)| *t += own);
        }
        for (row, w) in self.rows.iter().zip(w.last().into_iter().flatten()) {
            total.iter_mut().zip(row).for_each(|(t, a)| *t += a * w);
        }
        Ok(self.unknowns.adjoint(&self.theta, &total))
    }

    /// The objective `Σ ‖r_l‖² + (ρ/m) ‖θ‖²` and its gradient.
    ///
    /// # Errors
    /// Iterations stall.
    pub fn objective(&self, rho: f64) -> Result<(f64, Vec<f64>)> {
        // The mean square of θ is weighed, so that ρ does not depend on the number of unknowns.
        let share = rho / self.theta.len().max(1) as f64;
        let value = self.square() + share * self.theta.iter().map(|t| t * t).sum::<f64>();
        let slope = self.adjoint(&self.residuals, PRODUCT)?;
        Ok((value, slope.iter().zip(&self.theta).map(|(g, t)| 2.0 * (g + share * t)).collect()))
    }
}

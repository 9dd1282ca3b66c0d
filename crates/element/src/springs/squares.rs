//! Sums of squared distances, in which the strain of a membrane is linear.
//!
//! Theory: page *Sheets that bend* of the book.

use super::weighted::Weighted;
use crate::symbolic::Jet;

/// `c = Σ_i w_i |x_a − x_b|²`: a weighted sum of the squared distances of pairs of points. Its second derivatives are the same everywhere.
///
/// The gradients `∇N_a` of linear functions have the sum zero, so that `E = ½ (FᵀF − I) = −½ Σ_{a<b} (|x_a − x_b|² − |X_a − X_b|²) sym(∇N_a ⊗ ∇N_b)`: each
/// component of the strain of a triangle is such a sum, with weights in 1/m².
pub type Squares = Weighted<2>;

impl Squares {
    pub(super) fn value(&self, x: &[f64], dimension: usize) -> f64 {
        let square = |[a, b]: [usize; 2]| -> f64 {
            (0..dimension).map(|k| (x[b * dimension + k] - x[a * dimension + k]).powi(2)).sum()
        };
        self.iter().map(|(places, weight)| weight * square(places)).sum()
    }

    /// `∂c/∂x_b = 2 w (x_b − x_a)`, and its opposite at a.
    pub(super) fn gradient(&self, x: &[f64], dimension: usize) -> Vec<f64> {
        let mut gradient = vec![0.0; x.len()];
        for ([a, b], weight) in self.iter() {
            for (a, b) in (a * dimension..).zip(b * dimension..).take(dimension) {
                let slope = 2.0 * weight * (x[b] - x[a]);
                gradient[b] += slope;
                gradient[a] -= slope;
            }
        }
        gradient
    }

    pub(super) fn jet(&self, x: &[f64], dimension: usize) -> Jet {
        let n = x.len();
        let mut hessian = vec![0.0; n * n];
        for ([a, b], weight) in self.iter() {
            for (a, b) in (a * dimension..).zip(b * dimension..).take(dimension) {
                for (row, column, sign) in [(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)] {
                    hessian[row * n + column] += sign * 2.0 * weight;
                }
            }
        }
        Jet { value: self.value(x, dimension), gradient: self.gradient(x, dimension), hessian }
    }
}

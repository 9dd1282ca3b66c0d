//! The solvers of the linear equations of an implicit step.

use super::equations::Equations;
use super::factored::Factored;
use super::gradients::Gradients;
use crate::error::{Error, Result};
use crate::scalar::of_dimension;

/// The solver of the linear equations of an implicit step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum LinearSolver {
    /// A Cholesky factorisation, accurate to rounding. On membranes its size and the time of a solution grow as
    /// `n log n`, and the time of the factorisation as `n^(3/2)`. A linear model is factorised once.
    #[default]
    Factor,
    /// Conjugate gradients, preconditioned by an incomplete factor of blocks of one point, with some fill where the factor stays cheap,
    /// until `‖b − A x‖ ≤ tolerance ‖b‖`.
    ///
    /// The cost of an iteration per spring does not depend on the size of the model. The number of iterations grows
    /// with the square root of `h² k/m`, which is the number of springs that a wave crosses in one step; the size of
    /// the model, in springs, bounds it. A linear or linearised step starts from the displacement without acceleration.
    ConjugateGradients {
        /// The largest residual, relative to the right-hand side.
        tolerance: f64,
    },
}

/// The default tolerance of conjugate gradients.
// A Newton iteration leaves this share of the forces, so that two of them reach the 1e-10 at which a step ends by default. A
// smaller one takes iterations for digits that the next linearisation changes.
const TOLERANCE: f64 = 1e-8;

crate::named!(LinearSolver {
    "factor" => Factor,
    "conjugate-gradients" => ConjugateGradients { tolerance: TOLERANCE },
});

/// The smallest tolerance of conjugate gradients; smaller residuals are rounding errors.
pub const LEAST_TOLERANCE: f64 = 1e-15;

impl LinearSolver {
    pub(super) fn check(self) -> Result<()> {
        match self {
            LinearSolver::ConjugateGradients { tolerance } if !(LEAST_TOLERANCE..1.0).contains(&tolerance) => {
                Err(Error::expected("solver.tolerance", "a number from 1e-15 to below 1", format!("{tolerance:?}")))
            }
            _ => Ok(()),
        }
    }

    /// The equations for entries at these positions of the lower triangle, of points that are at `points` at rest,
    /// `[points × dimension]`, m; the diagonal is always included.
    pub(super) fn equations(
        self,
        places: &[(usize, usize)],
        held: &[bool],
        points: &[f64],
        dimension: usize,
    ) -> Result<Box<dyn Equations>> {
        Ok(match self {
            LinearSolver::Factor => Box::new(Factored::new(places, held, points, dimension)?),
            LinearSolver::ConjugateGradients { tolerance } => {
                of_dimension!(dimension, |D| Box::new(Gradients::<D>::new(places, held, tolerance)?))
            }
        })
    }
}

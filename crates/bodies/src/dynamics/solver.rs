//! The choice between the solvers of an implicit step's equations.

use super::equations::Equations;
use super::factored::Factored;
use super::gradients::Gradients;
use crate::error::{Error, Result};

/// How the linear equations of an implicit step are solved.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Solver {
    /// Cholesky's factor, to rounding. Its size and the time of a solution grow faster than the model, those of the factorisation
    /// faster still, as `n log n` and `n^(3/2)` on membranes; a linear model is factored once.
    #[default]
    Factor,
    /// Conjugate gradients with an incomplete factor of blocks of one point, without fill, as far as
    /// `‖b − A x‖ ≤ tolerance ‖b‖`. An iteration costs the same per spring in models of any size. How many there are depends on
    /// `h² k/m`, whose square root is how many springs far a step reaches, or on the size of the model in springs if that is less.
    /// A linear or linearised step starts from the way without acceleration.
    ConjugateGradients { tolerance: f64 },
}

/// The share of the right-hand side that conjugate gradients leave, unless another is given.
const TOLERANCE: f64 = 1e-8;

crate::named!(Solver {
    "factor" => Factor,
    "conjugate-gradients" => ConjugateGradients { tolerance: TOLERANCE },
});

/// Conjugate gradients go on until so much of the right-hand side is left; below is rounding.
pub const LEAST_TOLERANCE: f64 = 1e-15;

impl Solver {
    pub(super) fn check(self) -> Result<()> {
        match self {
            Solver::ConjugateGradients { tolerance } if !(LEAST_TOLERANCE..1.0).contains(&tolerance) => {
                Err(Error::expected("solver.tolerance", "a number from 1e-15 to below 1", format!("{tolerance:?}")))
            }
            _ => Ok(()),
        }
    }

    /// For entries at these places of the lower triangle, of points with `dimension` coordinates; the diagonal is in it anyway.
    pub(super) fn equations(
        self,
        places: &[(usize, usize)],
        held: &[bool],
        dimension: usize,
    ) -> Result<Box<dyn Equations>> {
        Ok(match self {
            Solver::Factor => Box::new(Factored::new(places, held)?),
            Solver::ConjugateGradients { tolerance } => match dimension {
                1 => Box::new(Gradients::<1>::new(places, held, tolerance)?),
                2 => Box::new(Gradients::<2>::new(places, held, tolerance)?),
                _ => Box::new(Gradients::<3>::new(places, held, tolerance)?),
            },
        })
    }
}

//! The equations of an implicit step: `A = c₂ M + c₁ C + K` on the free degrees of freedom, with the same pattern at every step.

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

/// How a solution ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Solved {
    pub end: End,
    /// Of conjugate gradients.
    pub iterations: usize,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    Exact,
    /// The iterations did not suffice; what they found is there.
    Rough,
    /// A direction of no or negative curvature was met.
    Indefinite,
}

/// The matrix and what solves it.
pub(super) trait Equations: std::fmt::Debug {
    /// The free degrees of freedom, in the order of the rows.
    fn order(&self) -> &[usize];

    /// `A ← D`, a diagonal of the degrees of freedom.
    fn set_diagonal(&mut self, diagonal: &dyn Fn(usize) -> f64);

    /// Adds `factor` times the values of the entries from the one numbered `first` on.
    fn add(&mut self, first: usize, factor: f64, values: &[f64]);

    /// Adds this share of the largest entry of the diagonal to all of it.
    fn shift(&mut self, share: f64);

    /// What solutions with this A have in common; false where A is known not to be positive definite.
    fn prepare(&mut self) -> bool;

    /// After [`Equations::prepare`], whether solving for `x`, a force that nothing is orthogonal to, meets positive curvature alone;
    /// `x` is lost.
    fn is_definite(&mut self, x: &mut [f64]) -> bool {
        self.solve(x, None).end != End::Indefinite
    }

    /// `x ← A⁻¹ x`, in the order of the rows; `guess` gives what may be near it for each degree of freedom.
    fn solve(&mut self, x: &mut [f64], guess: Option<&[f64]>) -> Solved;
}

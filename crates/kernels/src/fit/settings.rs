//! What a fit of each element is asked for.

use super::objective::Objective;
use super::rest::Rest;
use super::solver::Solver;
use crate::error::{Error, Result};
use crate::springs::Springs;

/// How the constants of each element are chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    pub objective: Objective,
    /// One constant per group instead of one per spring.
    pub tied: bool,
    /// No constant below zero.
    pub nonnegative: bool,
    pub solver: Solver,
    pub rest: Rest,
}

impl Fit {
    pub fn new(objective: Objective) -> Fit {
        Fit { objective, tied: false, nonnegative: false, solver: Solver::Native, rest: Rest::Mesh }
    }

    /// That its parts go together.
    ///
    /// # Errors
    /// They do not.
    pub(super) fn check(&self) -> Result<()> {
        self.solver.check(self.objective)?;
        self.rest.check(self.objective, self.solver)
    }

    /// That its springs do not pull at rest.
    ///
    /// # Errors
    /// They do.
    pub(super) fn check_constants_alone(&self) -> Result<()> {
        match self.rest {
            Rest::Mesh => Ok(()),
            Rest::Free | Rest::Zero => {
                let expected = "\"mesh\" where constants alone are asked for";
                Err(Error::expected("rest", expected, format!("\"{}\"", self.rest.name())))
            }
        }
    }

    /// Whether a cell takes microseconds instead of nanoseconds.
    pub(super) fn is_costly(&self) -> bool {
        self.objective.is_costly() || self.solver != Solver::Native
    }

    /// [`Fit::spread`] of any kind of number.
    pub(super) fn spread_of<T: Clone>(&self, springs: &Springs, k: &[T]) -> Vec<T> {
        (0..springs.len()).map(|s| k[if self.tied { springs.groups[s] } else { s }].clone()).collect()
    }

    /// One constant per spring from the solution of the equations, which has one per group where they are tied.
    pub(super) fn spread(&self, springs: &Springs, constants: &mut [f64], k: &[f64]) {
        for (s, constant) in constants.iter_mut().enumerate() {
            *constant = k[if self.tied { springs.groups[s] } else { s }];
        }
    }
}

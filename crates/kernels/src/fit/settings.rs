//! What a fit of each element is asked for.

use super::objective::Objective;
use super::solver::Solver;
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
}

impl Fit {
    pub fn new(objective: Objective) -> Fit {
        Fit { objective, tied: false, nonnegative: false, solver: Solver::Native }
    }

    /// Whether a cell takes microseconds instead of nanoseconds.
    pub(super) fn is_costly(&self) -> bool {
        self.objective.is_costly() || self.solver != Solver::Native
    }

    /// One constant per spring from the solution of the equations, which has one per group where they are tied.
    pub(super) fn spread(&self, springs: &Springs, constants: &mut [f64], k: &[f64]) {
        for (s, constant) in constants.iter_mut().enumerate() {
            *constant = k[if self.tied { springs.groups[s] } else { s }];
        }
    }
}

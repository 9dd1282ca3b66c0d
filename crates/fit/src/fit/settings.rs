//! The settings of a fit of each element.

use super::objective::Objective;
use super::rest::Rest;
use super::solver::Solver;
use super::spectral::GAP;
use crate::error::{Error, Result};
use crate::springs::Springs;

/// How the constants of each element are chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    /// What is minimised.
    pub objective: Objective,
    /// Whether there is one constant per group instead of one per spring.
    pub tied: bool,
    /// Whether no constant may be negative.
    pub nonnegative: bool,
    /// What minimises the objective.
    pub solver: Solver,
    /// The rest measures of the springs.
    pub rest: Rest,
    /// The search of a spectral fit may end at this proved gap, relative to the value; it is at most 1e-8. At zero the search ends where
    /// rounding ends it, which takes longer.
    pub gap: f64,
}

impl Fit {
    /// A fit with this objective, one free constant per spring, the native solver, and springs that do not pull at
    /// rest.
    pub fn new(objective: Objective) -> Fit {
        Fit { objective, tied: false, nonnegative: false, solver: Solver::Native, rest: Rest::Mesh, gap: 0.0 }
    }

    /// Checks that the settings are compatible.
    ///
    /// # Errors
    /// They are not.
    pub(super) fn check(&self) -> Result<()> {
        self.solver.check(self.objective)?;
        self.check_gap()?;
        self.rest.check(self.objective, self.solver)
    }

    /// Checks that the gap is one that the search can end at.
    ///
    /// # Errors
    /// It is not, or nothing proves a gap.
    pub fn check_gap(&self) -> Result<()> {
        match self.gap {
            0.0 => Ok(()),
            gap => {
                self.check_proofs()?;
                let is_meant = gap > 0.0 && gap <= GAP;
                if is_meant { Ok(()) } else { Err(Error::expected("gap", "a number from 0 to 1e-8", gap)) }
            }
        }
    }

    /// Checks that a gap is proved, for whoever names one.
    ///
    /// # Errors
    /// Nothing proves it.
    pub fn check_proofs(&self) -> Result<()> {
        match (self.objective, self.solver) {
            (Objective::Spectral(_), Solver::Native) => Ok(()),
            _ => Err(Error::at("gap", "belongs to objective = \"spectral\" with solver = \"native\"")),
        }
    }

    /// Checks that the springs do not pull at rest.
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

    /// [`Fit::spread`] for any kind of number.
    pub(super) fn spread_of<T: Clone>(&self, springs: &Springs, k: &[T]) -> Vec<T> {
        (0..springs.len()).map(|s| k[if self.tied { springs.groups()[s] } else { s }].clone()).collect()
    }

    /// Writes one constant per spring from the solution of the equations, which has one per group if they are tied.
    pub(super) fn spread(&self, springs: &Springs, constants: &mut [f64], k: &[f64]) {
        for (s, constant) in constants.iter_mut().enumerate() {
            *constant = k[if self.tied { springs.groups()[s] } else { s }];
        }
    }
}

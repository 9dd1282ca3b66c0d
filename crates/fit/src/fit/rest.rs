//! The rest lengths, or rest measures, of the springs of a fit.
//!
//! Theory: page *Exact networks and patches* of the book.

use super::objective::Objective;
use super::solver::Solver;
use crate::error::{Error, Result};

/// The choice of the rest measure c₀ of a spring that measures c at the rest shape of the mesh. With `T = k (c − c₀)`
/// its tangent at rest is `k g gᵀ + T ∇∇c`. All springs of a cell together exert no force at rest: `Σ_s T_s g_s = 0`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Rest {
    /// `c₀ = c`: no spring pulls at rest.
    #[default]
    Mesh,
    /// k and T are both unknown. Tied springs share k and the ratio c₀/c.
    Free,
    /// `c₀ = 0` for springs on lengths, so that `T = k ℓ`; the others are as in [`Rest::Free`].
    Zero,
}

crate::named!(Rest { "mesh" => Mesh, "free" => Free, "zero" => Zero });

impl Rest {
    /// Checks that the objective and the solver can determine tensions.
    ///
    /// # Errors
    /// They cannot.
    pub fn check(self, objective: Objective, solver: Solver) -> Result<()> {
        let refuse = |other: &str, possible: &str| {
            let expected = format!("\"mesh\" with {other}; \"free\" and \"zero\" go with {possible}");
            Err(Error::expected("rest", expected, format!("\"{}\"", self.name())))
        };
        match (self, objective.least_squares(), solver) {
            (Rest::Mesh, ..) | (_, Some(_), Solver::Native) => Ok(()),
            (_, Some(_), Solver::General { .. }) => {
                refuse(&format!("the solver \"{}\"", solver.name()), "the solver \"native\"")
            }
            (_, None, _) => {
                let possible = "the objectives \"frobenius\", \"offdiag\" and \"modal\"";
                refuse(&format!("the objective \"{}\"", objective.name()), possible)
            }
        }
    }

    /// The addition to the title of a fit.
    pub fn title(self) -> &'static str {
        match self {
            Rest::Mesh => "",
            Rest::Free => " free rest",
            Rest::Zero => " zero rest",
        }
    }
}

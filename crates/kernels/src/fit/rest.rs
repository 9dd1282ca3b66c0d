//! How long the springs of a fit are when they do not pull.

use super::objective::Objective;
use super::solver::Solver;
use crate::error::{Error, Result};

/// The measure at rest, c₀, of a spring that measures c at the rest shape of the mesh. With `T = k (c − c₀)` its tangent there is
/// `k g gᵀ + T ∇∇c`. All springs of a cell together exert no force at rest: `Σ_s T_s g_s = 0`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Rest {
    /// `c₀ = c`: no spring pulls.
    #[default]
    Mesh,
    /// k and T are both unknown. Tied springs share k and the ratio c₀/c.
    Free,
    /// `c₀ = 0` of the springs on lengths, `T = k ℓ`; the others are as in [`Rest::Free`].
    Zero,
}

crate::named!(Rest { "mesh" => Mesh, "free" => Free, "zero" => Zero });

impl Rest {
    /// That tensions can be unknowns of the objective and the solver.
    ///
    /// # Errors
    /// They cannot.
    pub fn check(self, objective: Objective, solver: Solver) -> Result<()> {
        let refuse = |other: &str, possible: &str| {
            let expected = format!("\"mesh\" with {other}; \"free\" and \"zero\" go with {possible}");
            Err(Error::expected("rest", expected, format!("\"{}\"", self.name())))
        };
        match (self, objective, solver) {
            (Rest::Mesh, ..) | (_, Objective::Frobenius(_), Solver::Native) => Ok(()),
            (_, Objective::Frobenius(_), Solver::General { .. }) => {
                refuse(&format!("the solver \"{}\"", solver.name()), "the solver \"native\"")
            }
            (_, Objective::Spectral(_) | Objective::Divergence(_), _) => {
                let possible = "the objectives \"frobenius\", \"offdiag\" and \"modal\"";
                refuse(&format!("the objective \"{}\"", objective.name()), possible)
            }
        }
    }

    /// What it adds to the title of a fit.
    pub fn title(self) -> &'static str {
        match self {
            Rest::Mesh => "",
            Rest::Free => " free rest",
            Rest::Zero => " zero rest",
        }
    }
}

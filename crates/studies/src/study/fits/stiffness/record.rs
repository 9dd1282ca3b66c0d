//! The settings of a fit to the stiffness at rest in a report.

use crate::fit::{Fit, Objective, Rest, Solver};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The settings, with defaults filled in. Settings that the objective does not have are null.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StiffnessRecord {
    /// The objective.
    pub objective: String,
    /// The weight of a norm.
    pub weight: Option<String>,
    /// The scale of the motions beyond constant strain.
    pub higher: Option<f64>,
    /// The balance of the divergence, from 0 (soft) to 1 (stiff).
    pub balance: Option<f64>,
    /// Whether there is one constant per group.
    pub tied: bool,
    /// Whether no constant may be negative.
    pub nonnegative: bool,
    /// The solver.
    pub solver: String,
    /// The cost of a spring, as a share of the objective at the start.
    pub sparsity: Option<f64>,
    /// The rest measures: `mesh`, `free` or `zero`.
    pub rest: String,
    /// The gap at which a spectral fit may end.
    pub gap: Option<f64>,
}

impl StiffnessRecord {
    pub(super) fn of(fit: &Fit) -> StiffnessRecord {
        let solver = match (fit.solver, fit.rest) {
            (Solver::General { .. }, _) => fit.solver.name(),
            (Solver::Native, Rest::Mesh) => fit.objective.method_name(fit.nonnegative),
            (Solver::Native, _) if fit.nonnegative => "interior point",
            (Solver::Native, _) => "orthogonal least squares",
        };
        StiffnessRecord {
            objective: fit.objective.name().into(),
            weight: fit.objective.weight().map(|weight| weight.name().into()),
            higher: fit.objective.higher(),
            balance: fit.objective.balance(),
            tied: fit.tied,
            nonnegative: fit.nonnegative,
            solver: solver.into(),
            sparsity: fit.solver.topology().map(|topology| topology.sparsity),
            rest: fit.rest.name().into(),
            gap: matches!((fit.objective, fit.solver), (Objective::Spectral(_), Solver::Native)).then_some(fit.gap),
        }
    }
}

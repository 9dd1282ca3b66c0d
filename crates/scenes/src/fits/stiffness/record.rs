//! The settings of a fit to the stiffness at rest in a report.

use crate::fit::{Fit, Objective, Rest, Solver};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The settings, with defaults filled in. Settings that the objective does not have are null.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "(stiffness)")]
pub struct StiffnessRecord {
    /// The objective has this name.
    pub objective: String,
    /// The norm has this weight; it is null if the objective has none.
    pub weight: Option<String>,
    /// Motions beyond constant strain have this scale; it is null without a modal weight.
    pub higher: Option<f64>,
    /// The divergence has this balance from 0 (soft) to 1 (stiff); it is null with other objectives.
    pub balance: Option<f64>,
    /// All springs of a group have one constant.
    pub tied: bool,
    /// No constant may be negative.
    pub nonnegative: bool,
    /// The solver is `normal equations`, `block principal pivoting`, `barrier`, `newton`, `interior point`, `orthogonal least squares`, or
    /// a general optimiser.
    pub solver: String,
    /// Each spring adds this share of the objective at the start; it is null without a search of topologies.
    pub sparsity: Option<f64>,
    /// Rest measures are those of the `mesh`, `free` or `zero`.
    pub rest: String,
    /// A spectral fit may end at this proved gap; it is null with other objectives.
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

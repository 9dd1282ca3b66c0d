//! The keys of a `[[fit]]` to the stiffness at rest.

use crate::error::{Error, Result};
use crate::fit::{Choices, Fit, Objective, Rest, Solver, Topology, Weight};
use schemars::JsonSchema;
use serde::Deserialize;

/// The keys.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct StiffnessEntry {
    #[schemars(extend("enum" = Weight::NAMES))]
    pub weight: Option<String>,
    pub higher: Option<f64>,
    pub balance: Option<f64>,
    pub tied: bool,
    pub nonnegative: bool,
    #[schemars(extend("enum" = Solver::NAMES))]
    pub solver: Option<String>,
    /// These three belong to the general solvers.
    pub iterations: Option<u64>,
    pub topology: bool,
    pub sparsity: Option<f64>,
    #[schemars(extend("enum" = Rest::NAMES))]
    pub rest: Option<String>,
    pub gap: Option<f64>,
}

impl StiffnessEntry {
    /// The fit with the objective of this name.
    ///
    /// # Errors
    /// The objective, the solver or the rest measure is unknown; a number is out of its range; or settings contradict
    /// each other.
    pub fn fit(&self, objective: &str) -> Result<Fit> {
        let choices = Choices { weight: self.weight.as_deref(), higher: self.higher, balance: self.balance };
        let objective = Objective::named(objective, choices)?;
        let topology = self.topology.then(|| Topology { sparsity: self.sparsity.unwrap_or(0.0) });
        if let (None, Some(_)) = (topology, self.sparsity) {
            return Err(Error::at("sparsity", "belongs to topology = true"));
        }
        let solver = Solver::named(self.solver.as_deref().unwrap_or("native"), self.iterations, topology)?;
        let rest = self.rest.as_deref().map_or(Ok(Rest::Mesh), Rest::named).map_err(|e| e.at_key("rest"))?;
        rest.check(objective, solver)?;
        let gap = self.gap.unwrap_or(0.0);
        let fit = Fit { objective, tied: self.tied, nonnegative: self.nonnegative, solver, rest, gap };
        if self.gap.is_some() {
            fit.check_proofs()?;
        }
        fit.check_gap()?;
        Ok(fit)
    }
}

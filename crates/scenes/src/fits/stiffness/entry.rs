//! The keys of a `[[fit]]` to the stiffness at rest.

use crate::error::{Error, Result};
use crate::fit::{Balance, Choices, Fit, Higher, Objective, Rest, Solver, Topology, Weight};
use schemars::JsonSchema;
use serde::Deserialize;

/// The keys.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct StiffnessEntry {
    /// The weight says which parts of the difference R − K count. It belongs to `frobenius` and, but for `offdiag`, to `spectral`.
    #[schemars(extend("enum" = Weight::NAMES, "default" = Weight::None.name()))]
    pub weight: Option<String>,
    /// Motions beyond constant strain have this scale in modal weights, above 0 and at most 1.
    #[schemars(extend("default" = Higher::DEFAULT.value()))]
    pub higher: Option<f64>,
    /// The `divergence` is balanced between too soft, 0, and too stiff, 1.
    #[schemars(extend("default" = Balance::DEFAULT.value()))]
    pub balance: Option<f64>,
    /// All springs of a group have one constant.
    pub tied: bool,
    /// No constant is below zero.
    pub nonnegative: bool,
    /// The solver is that of the objective (`native`), or a general optimiser.
    #[schemars(extend("enum" = Solver::NAMES, "default" = "native"))]
    pub solver: Option<String>,
    /// A general optimiser takes this number of iterations, 1 or more.
    #[schemars(extend("default" = Solver::DEFAULT_ITERATIONS))]
    pub iterations: Option<u64>,
    /// The optimiser may also switch springs off; the key belongs to `particle-swarm` and `simulated-annealing`.
    pub topology: bool,
    /// Each remaining spring adds this share of the objective at the start to the objective, 0 or more; the key belongs to `topology =
    /// true`.
    #[schemars(extend("default" = 0))]
    pub sparsity: Option<f64>,
    /// Rest measures are those of the mesh (`mesh`), fitted as well (`free`), or zero (`zero`), with `frobenius`, `offdiag` and `modal`.
    #[schemars(extend("enum" = Rest::NAMES, "default" = Rest::Mesh.name()))]
    pub rest: Option<String>,
    /// The search of `spectral` may end at this proved gap, relative to the value, from 0 to 1e-8; at 0 rounding ends it.
    #[schemars(extend("default" = 0))]
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

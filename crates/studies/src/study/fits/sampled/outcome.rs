//! The errors of a sampled fit.

use super::recipe::SampledRecipe;
use crate::fit::{SampledFits, Spread};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The relative errors of the forces, `√(Σ w ‖f − K‖²/Σ w ‖f‖²)` for each cell, with the weights w of the fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SampledOutcome {
    /// The springs are fitted to this number of shapes, those of the element with the most.
    pub shapes: usize,
    /// The shapes of a list of gradients that may be fitted; `None` if they are not from a list.
    #[serde(skip)]
    pub listed: Option<usize>,
    /// The forces have these relative errors on the shapes of the fit: `√(Σ w ‖f − K‖²/Σ w ‖f‖²)` with the weights w of the fit, so that
    /// with `weight = "none"` the errors of all shapes are relative to the forces of all shapes.
    pub trained: Spread,
    /// The forces have these relative errors on the shapes that were held out; they are null if there are none.
    pub held_out: Option<Spread>,
    /// At least this share of starts found the best parameters; it is null with a single start.
    #[serde(rename = "agreeing_starts")]
    pub agreeing: Option<f64>,
    /// The shapes of these loads of the scene were sampled; errors under them are not held out.
    pub loads: Vec<String>,
}

impl SampledOutcome {
    /// The outcome of the fits of all blocks of cells.
    pub(super) fn of(recipe: &SampledRecipe, found: &[SampledFits], dimension: usize) -> SampledOutcome {
        let spread =
            |of: fn(&SampledFits) -> &Vec<f64>| Spread::of(&found.iter().flat_map(of).copied().collect::<Vec<f64>>());
        let apart = found.iter().flat_map(|f| &f.held_out).all(|error| error.is_finite());
        let held_out = apart.then(|| spread(|f| &f.held_out));
        SampledOutcome {
            shapes: found.iter().map(|found| found.shapes).max().unwrap_or(0),
            listed: recipe.fit.sampling.listed(dimension).map(|[own, _]| own),
            trained: spread(|f| &f.trained),
            held_out,
            agreeing: found.iter().filter_map(|f| f.agreeing).reduce(f64::min),
            loads: recipe.loads.clone(),
        }
    }
}

/// A fit with a larger relative error than this does not describe the body.
const UNEXPLAINED: f64 = 0.1;

impl SampledOutcome {
    /// The largest relative error of a cell, at the shapes of the fit and at those held out.
    fn unexplained(&self) -> f64 {
        self.held_out.iter().map(|spread| spread.max).fold(self.trained.max, f64::max)
    }

    /// Notes for the reader, one sentence each.
    pub fn notes(&self) -> Vec<String> {
        let unexplained = Some(self.unexplained()).filter(|share| !(*share <= UNEXPLAINED)).map(|share| {
            format!(
                "in the worst element it leaves {:.2} % of the sampled forces unexplained: its springs or its law of force \
                 cannot describe the material there",
                100.0 * share
            )
        });
        let loads = (!self.loads.is_empty()).then(|| {
            format!(
                "fitted to the shapes of the finite elements under {}: its errors under them are not predictions",
                self.loads.join(", ")
            )
        });
        let agreeing = self.agreeing.filter(|share| *share < 1.0).map(|agreeing| {
            format!(
                "in the worst element {:.0} % of the starts reached the best parameters, and the others ended at worse ones",
                100.0 * agreeing
            )
        });
        let left_out = self.listed.filter(|listed| self.shapes < *listed).map(|listed| {
            let shapes = self.shapes;
            format!("fitted to the first {shapes} of the {listed} shapes of the list that are not held out: all are taken without count")
        });
        unexplained.into_iter().chain(left_out).chain(loads).chain(agreeing).collect()
    }
}

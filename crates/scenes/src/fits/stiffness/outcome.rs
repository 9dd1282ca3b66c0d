//! The results of a fit to the stiffness at rest.

use super::tension::TensionOutcome;
use crate::fit::{CellFits, Fit, MotionWeight, Objective};

/// The certificates of a fit to the stiffness at rest, and the tension of its springs.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct StiffnessOutcome {
    /// The number of cells whose spectral optimum is not unique.
    pub ambiguous: usize,
    /// The largest relative duality gap; `None` if the objective has no certificates.
    pub gap: Option<f64>,
    /// The relative error of the energy: the least ε with `(1 − ε) R ⪯ K ⪯ (1 + ε) R` in every cell, if ε < 1.
    pub energy_error: Option<f64>,
    /// The tension of the springs at rest; `None` if no spring pulls.
    pub tension: Option<TensionOutcome>,
}

impl StiffnessOutcome {
    pub(super) fn of(fit: &Fit, cells: &[CellFits]) -> StiffnessOutcome {
        let certificates = || cells.iter().flat_map(|cells| &cells.certificates);
        let largest = certificates().map(|c| c.value).reduce(f64::max);
        let relative = fit.objective == Objective::Spectral(MotionWeight::Relative);
        StiffnessOutcome {
            ambiguous: certificates().filter(|c| c.ambiguous).count(),
            gap: certificates().map(|c| c.gap()).reduce(f64::max),
            energy_error: largest.filter(|epsilon| relative && *epsilon < 1.0),
            tension: None,
        }
    }

    /// Notes for the reader, one sentence each.
    pub fn notes(&self) -> Vec<String> {
        let gap = self.gap.map(|gap| {
            let mut note =
                format!("certified: no constants have an error that is smaller by more than a share of {gap:.1e}");
            if self.ambiguous > 0 {
                let others = "the optimum is not unique, and the one with the smallest Frobenius error is used";
                let elements = if self.ambiguous == 1 { "element" } else { "elements" };
                note += &format!("; in {} {elements} {others}", self.ambiguous);
            }
            note
        });
        let energy = self
            .energy_error
            .map(|epsilon| format!("the energy of every deformation is within {:.1} % of the body's", 100.0 * epsilon));
        let tension = self.tension.iter().flat_map(TensionOutcome::notes);
        gap.into_iter().chain(energy).chain(tension).collect()
    }
}

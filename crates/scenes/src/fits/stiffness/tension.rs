//! The tension at rest of a fit whose springs have rest measures of their own.

use crate::fit::{CellFits, Spread};
use crate::model::{Network, RestTension};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The tension of a network whose springs pull at rest.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct TensionOutcome {
    /// The rest lengths, and how well the springs are in equilibrium.
    #[serde(flatten)]
    pub network: RestTension,
    /// This number of elements has no springs: only springs without a force satisfy the conditions of the fit.
    #[serde(rename = "idle_elements")]
    pub idle: usize,
}

impl TensionOutcome {
    pub(super) fn of(cells: &[CellFits], network: &Network, points: &[f64]) -> TensionOutcome {
        let idle = |fits: &CellFits| {
            // An element may have no springs of the groups that were chosen: chunks of none would panic.
            let count = fits.springs.len().max(1);
            let pairs = fits.constants.chunks_exact(count).zip(fits.parameters.chunks_exact(count));
            pairs.filter(|(k, p)| k.iter().chain(*p).all(|number| *number == 0.0)).count()
        };
        TensionOutcome { network: RestTension::of(network, points), idle: cells.iter().map(idle).sum() }
    }

    /// Notes for the reader, one sentence each.
    pub(super) fn notes(&self) -> Vec<String> {
        let RestTension { rest_lengths: Spread { mean, max }, negative, steady, unbalanced } = self.network;
        let mut notes = vec![format!(
            "the rest lengths differ from the lengths in the mesh by {:.3} % on average and {:.3} % at most; the forces on the \
             nodes at rest are {unbalanced:.1e} of the largest force of a spring",
            100.0 * mean,
            100.0 * max
        )];
        let mut count = |count: usize, text: &str| {
            if count > 0 {
                notes.push(format!("{count} {text}"));
            }
        };
        count(negative, "springs have a negative rest length, which some simulators do not accept");
        count(steady, "springs pull with a constant force, by a law of force, and have no rest length");
        count(self.idle, "elements have no springs: only constants of zero satisfy the conditions of the fit");
        notes
    }
}

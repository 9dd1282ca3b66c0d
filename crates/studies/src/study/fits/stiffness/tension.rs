//! The tension at rest of a fit whose springs have rest measures of their own.

use crate::fit::{CellFits, Spread};
use crate::model::{Network, RestTension};
use crate::study::fits::spread::SpreadRecord;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The tension of a network whose springs pull at rest.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TensionOutcome {
    /// The rest lengths, and how well the springs are in equilibrium.
    pub network: RestTension,
    /// The number of cells in which only springs without a force satisfy the conditions of the fit.
    pub idle: usize,
}

/// The record of the tension in a report.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TensionRecord {
    /// Rest lengths deviate by the shares `|rest length / length in the mesh − 1|`, for springs between two points.
    pub rest_lengths: SpreadRecord,
    /// This number of springs has a rest length below zero.
    pub negative_rest_lengths: usize,
    /// This number of springs has a force that does not depend on what they measure.
    pub constant_forces: usize,
    /// The largest force on a node at rest is this share of the largest force of a spring.
    pub unbalanced: f64,
    /// This number of elements has no springs.
    pub idle_elements: usize,
}

impl TensionOutcome {
    pub(super) fn of(cells: &[CellFits], network: &Network, points: &[f64]) -> TensionOutcome {
        let idle = |fits: &CellFits| {
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

impl From<&TensionOutcome> for TensionRecord {
    fn from(outcome: &TensionOutcome) -> TensionRecord {
        let TensionOutcome { network, idle } = outcome;
        TensionRecord {
            rest_lengths: Some(network.rest_lengths).into(),
            negative_rest_lengths: network.negative,
            constant_forces: network.steady,
            unbalanced: network.unbalanced,
            idle_elements: *idle,
        }
    }
}

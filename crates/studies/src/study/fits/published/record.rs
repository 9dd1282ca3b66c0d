//! The record of a published method in a report.

use crate::fit::published::{Method, Unmet};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The method, and where it is published.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "(published)")]
pub struct PublishedRecord {
    /// The objective is the name of a published formula.
    pub objective: String,
    /// The formula is published there.
    pub source: String,
}

/// The assumptions of the method that are not met.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PublishedOutcomeRecord {
    /// The formula has this Poisson's ratio; it is null if the material has it too.
    pub poisson_assumed: Option<f64>,
    /// This number of elements has another shape than the formula assumes.
    pub elements_of_other_shape: usize,
    /// Their lengths deviate from those of the assumed shape by at most this share.
    pub largest_deviation: f64,
}

impl PublishedRecord {
    pub(super) fn of(method: Method) -> PublishedRecord {
        PublishedRecord { objective: method.name().into(), source: method.reference().into() }
    }
}

impl PublishedOutcomeRecord {
    /// The record of these assumptions.
    pub fn of(unmet: &Unmet) -> PublishedOutcomeRecord {
        let Unmet { poisson, cells, deviation, .. } = *unmet;
        PublishedOutcomeRecord {
            poisson_assumed: poisson,
            elements_of_other_shape: cells,
            largest_deviation: deviation,
        }
    }
}

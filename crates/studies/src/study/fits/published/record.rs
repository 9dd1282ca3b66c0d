//! The record of a published method in a report.

use crate::fit::published::{Method, Unmet};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The method, and where it is published.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PublishedRecord {
    /// The name of the method.
    pub objective: String,
    /// The paper.
    pub source: String,
}

/// The assumptions of the method that are not met.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PublishedOutcomeRecord {
    /// The Poisson's ratio of the formula, if that of the material is different.
    pub poisson_assumed: Option<f64>,
    /// The number of elements of another shape than the formula assumes.
    pub elements_of_other_shape: usize,
    /// The largest relative deviation of their lengths from those of the assumed shape.
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

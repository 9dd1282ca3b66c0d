//! A published method, as a report has it.

use crate::fit::published::{Method, Unmet};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The method and where it was published.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PublishedRecord {
    pub objective: String,
    pub source: String,
}

/// The assumptions of the method that are not met.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PublishedOutcomeRecord {
    /// Poisson's ratio of the formula, where that of the material is another.
    pub poisson_assumed: Option<f64>,
    pub elements_of_other_shape: usize,
    /// Of their lengths from those of the formula, as a share.
    pub largest_deviation: f64,
}

impl PublishedRecord {
    pub(super) fn of(method: Method) -> PublishedRecord {
        PublishedRecord { objective: method.name().into(), source: method.reference().into() }
    }
}

impl PublishedOutcomeRecord {
    pub fn of(unmet: &Unmet) -> PublishedOutcomeRecord {
        let Unmet { poisson, cells, deviation, .. } = *unmet;
        PublishedOutcomeRecord {
            poisson_assumed: poisson,
            elements_of_other_shape: cells,
            largest_deviation: deviation,
        }
    }
}

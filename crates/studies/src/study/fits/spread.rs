//! Means and maxima over elements in a report.

use crate::fit::Spread;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The mean and the maximum of a number over the elements; null if there is none.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SpreadRecord {
    /// The mean is taken over the elements.
    pub mean: Option<f64>,
    /// The largest value is taken over the elements.
    pub max: Option<f64>,
}

impl From<Option<Spread>> for SpreadRecord {
    fn from(spread: Option<Spread>) -> SpreadRecord {
        SpreadRecord { mean: spread.map(|s| s.mean), max: spread.map(|s| s.max) }
    }
}

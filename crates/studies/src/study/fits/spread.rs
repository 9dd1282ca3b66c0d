//! Means and maxima over elements, as a report has them.

use crate::fit::Spread;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The mean and the largest of a figure; null if there is none.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SpreadRecord {
    pub mean: Option<f64>,
    pub max: Option<f64>,
}

impl From<Option<Spread>> for SpreadRecord {
    fn from(spread: Option<Spread>) -> SpreadRecord {
        SpreadRecord { mean: spread.map(|s| s.mean), max: spread.map(|s| s.max) }
    }
}

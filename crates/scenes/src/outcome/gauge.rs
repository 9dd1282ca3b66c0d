//! The readings of a gauge.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Young's modulus, Pa, and Poisson's ratio of a specimen under a load, as a gauge measures them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Reading {
    /// Young's modulus is `F/(A ε)` in Pa, with the resultant F of the load along the axis, the cross-section A and the strain ε along the
    /// axis.
    pub young: f64,
    /// Poisson's ratio is `−ε_across/ε`, the mean over the directions across.
    pub poisson: f64,
}

/// The result of a gauge under a load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GaugeResult {
    /// The reading.
    Reading(Reading),
    /// There is none: the load does not cause the same force in the whole gauge, or it was not reached.
    NoReading,
}

impl GaugeResult {
    /// The reading, if there is one.
    pub fn reading(self) -> Option<Reading> {
        match self {
            GaugeResult::Reading(reading) => Some(reading),
            GaugeResult::NoReading => None,
        }
    }
}

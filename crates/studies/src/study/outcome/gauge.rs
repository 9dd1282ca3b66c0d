//! What a gauge measures.

/// Young's modulus and Poisson's ratio of a specimen under a load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// `F/(A ε)`: the load's resultant along the axis, the cross-section, the strain along the axis; Pa.
    pub young: f64,
    /// `−ε_across/ε`, the mean of the directions across.
    pub poisson: f64,
}

/// The result of a gauge under a load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GaugeResult {
    Reading(Reading),
    /// The load is not the same force in the whole gauge, or it was not reached.
    NoReading,
}

impl GaugeResult {
    pub fn reading(self) -> Option<Reading> {
        match self {
            GaugeResult::Reading(reading) => Some(reading),
            GaugeResult::NoReading => None,
        }
    }
}

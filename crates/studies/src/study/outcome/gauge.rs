//! The readings of a gauge.

/// Young's modulus and Poisson's ratio of a specimen under a load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// `F/(A ε)`, Pa, with F the resultant of the load along the axis, A the cross-section and ε the strain along the
    /// axis.
    pub young: f64,
    /// `−ε_across/ε`, the mean over the directions across.
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

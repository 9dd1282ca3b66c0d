//! Where a model in motion is.

use super::pass;

/// Displacements and velocities of a model at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionState {
    /// The time, s.
    pub time: f64,
    /// The displacements from the positions at rest, `[points · dimension]`, m.
    pub displacement: Vec<f64>,
    /// The velocities, `[points · dimension]`, m/s.
    pub velocity: Vec<f64>,
}

impl MotionState {
    /// Whether no displacement is larger than this, m, and every velocity is a number.
    pub(super) fn is_within(&self, largest: f64) -> bool {
        pass::all(&self.displacement, |u| u.abs() <= largest) && pass::all(&self.velocity, f64::is_finite)
    }
}

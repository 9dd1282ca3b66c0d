//! Where a model in motion is.

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
    pub fn is_within(&self, largest: f64) -> bool {
        // Without an early end the compiler compares several numbers at a time.
        let near = self.displacement.iter().fold(true, |near, u| near & (u.abs() <= largest));
        self.velocity.iter().fold(near, |near, v| near & v.is_finite())
    }
}

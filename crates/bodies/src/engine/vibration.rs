//! Natural vibrations in an engine.
//!
//! Theory: page *Networks in engines* of the book.

/// A natural vibration in an engine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vibration {
    /// The frequency, Hz.
    pub frequency: f64,
    /// The damping ratio.
    pub damping: f64,
}

impl Vibration {
    /// That with the eigenvalue κ of `W K_N`, 1/s², in substeps of h; `None` if it is no vibration.
    pub(super) fn of(kappa: f64, substep: f64) -> Option<Vibration> {
        let square = 1.0 - substep * substep * kappa;
        // The square is that of the factor on the amplitude: at zero a substep ends all motion, and nothing vibrates.
        if !(square > 0.0) {
            return None;
        }
        let factor = square.sqrt();
        let angle = factor.acos();
        Some(Vibration { frequency: angle / (substep * std::f64::consts::TAU), damping: -factor.ln() / angle })
    }
}

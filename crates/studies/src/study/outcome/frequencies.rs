//! Natural frequencies.

/// The lowest natural frequencies of one model, with masses lumped at its points.
#[derive(Debug, Clone, PartialEq)]
pub struct FrequencyOutcome {
    /// Of the fit, or "finite elements".
    pub name: String,
    /// Motions without stiffness that are left out: those of rigid bodies that `[[fix]]` leaves free.
    pub rigid: usize,
    /// Hz, ascending; or why there are none.
    pub found: std::result::Result<Vec<f64>, String>,
}

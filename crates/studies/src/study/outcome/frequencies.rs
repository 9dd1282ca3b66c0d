//! Natural frequencies of a model.

/// The lowest natural frequencies of one model, with masses lumped at its points.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct FrequencyOutcome {
    /// The name of the fit, or "finite elements".
    pub name: String,
    /// The number of motions without stiffness that are left out: the rigid motions that `[[fix]]` leaves free.
    pub rigid: usize,
    /// The frequencies, Hz, ascending; or the reason why there are none.
    pub found: std::result::Result<Vec<f64>, String>,
}

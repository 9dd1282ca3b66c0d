//! Whether sweeps that take all springs at once come to an end.
//!
//! Theory: page *Networks in engines* of the book.

use super::constraints::Constraints;
use super::setting::Setting;
use crate::error::{Error, ErrorKind, Result};
use crate::model::Network;

/// Checks that sweeps which take all springs at once come to an end.
///
/// # Errors
/// They grow; the kind is `Unsupported`, and the error has the substeps with which they end.
pub(super) fn check_growth(
    constraints: &Constraints,
    (network, points, inverse): (&Network, &[f64], &[f64]),
    setting: &Setting,
) -> Result<()> {
    let growth = constraints.growth(points.len());
    if growth < STABLE {
        return Ok(());
    }
    let is_stable = |substeps: usize| {
        let setting = setting.with_substeps(substeps);
        Constraints::new(network, (points, inverse), &setting, false).growth(points.len()) < STABLE
    };
    let (mut below, mut above) = (setting.substeps, 2 * setting.substeps);
    while !is_stable(above) && above < LARGE {
        (below, above) = (above, 2 * above);
    }
    // To a percent: the number is advice, not a bound.
    while above - below > 1 + below / 100 {
        let middle = (below + above) / 2;
        if is_stable(middle) { above = middle } else { below = middle }
    }
    let expected = format!(
        "{above} substeps or more of a step of {:.3e} s: sweeps that take all springs at once grow without bound with longer ones",
        setting.step
    );
    let found = format!("{}", setting.substeps);
    let advice = "; there they are nearly converged, so that constants for this engine are those of other fits";
    Err(Error::expected("engine.substeps", expected, found).followed_by(advice).of_kind(ErrorKind::Unsupported))
}

/// The largest eigenvalue of `ω D⁻¹ A` with which sweeps end, below 2 by what the power method may miss.
const STABLE: f64 = 1.98;
/// More substeps than are looked for.
const LARGE: usize = 1 << 24;

//! Numbers in reports.

/// Null in JSON where it is not finite.
pub(super) fn finite(value: f64) -> Option<f64> {
    Some(value).filter(|value| value.is_finite())
}

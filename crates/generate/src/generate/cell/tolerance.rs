//! The shares below which numbers count as rounding errors, in double and in single precision. They are those of the
//! kernels.

use super::Value;
use crate::scalar::Scalar;

/// Rounding errors of single precision are this much larger.
const SINGLE: f64 = (f32::EPSILON as f64) / f64::EPSILON;
/// A pivot below this share of its diagonal entry is a rounding error.
pub const RANK: f64 = 1000.0 * f64::EPSILON / 2.0;
/// The square of the share of the product of their lengths below which the product of two gradients is one.
pub const PRODUCT: f64 = 1e-13 * 1e-13;

/// A tolerance in single precision; any other number as it is.
pub fn in_single(number: f64) -> f64 {
    let delicate = Value::delicate();
    match number {
        _ if number == RANK => number * SINGLE,
        // A few roundings: 1e-13 is a thousand of them.
        _ if number == PRODUCT || number == delicate * delicate => number * SINGLE * SINGLE,
        _ => number,
    }
}

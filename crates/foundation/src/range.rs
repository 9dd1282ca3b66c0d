//! The range of sizes that a physical quantity in an input may have.
//!
//! Within this range the products and squares that energies and their gradients consist of neither overflow nor
//! underflow `f64`.

use crate::error::{Error, Result};

/// The smallest size of a quantity other than zero, in its SI unit. Its tenth power is still a normal `f64`.
pub const LEAST: f64 = 1e-30;
/// The largest size of a quantity, in its SI unit. Its tenth power is still below the largest `f64`.
pub const LARGEST: f64 = 1e30;

/// Whether a positive quantity is within the range.
pub fn contains(value: f64) -> bool {
    (LEAST..=LARGEST).contains(&value)
}

/// Checks that a quantity is above zero and within the range. `unit`, such as `Pa` or `metres per mesh unit`, is for
/// the message.
///
/// # Errors
/// The value is not above zero, or is outside the range.
pub fn positive(key: &str, value: f64, unit: &str) -> Result<f64> {
    match value {
        v if contains(v) => Ok(v),
        v if !(v > 0.0 && v.is_finite()) => Err(Error::expected(key, format!("a positive number of {unit}"), v)),
        v => Err(Error::expected(key, format!("a number from {LEAST:e} to {LARGEST:e} {unit}"), format!("{v:?}"))),
    }
}

/// Checks that a quantity is zero or above and within the range.
///
/// # Errors
/// The value is below zero, or is outside the range.
pub fn not_negative(key: &str, value: f64, unit: &str) -> Result<f64> {
    if value == 0.0 || contains(value) {
        return Ok(value);
    }
    let expected = format!("0 or a number from {LEAST:e} to {LARGEST:e} {unit}");
    Err(Error::expected(key, expected, format!("{value:?}")))
}

/// Checks that a quantity of either sign, such as a coordinate, is finite and not above the range.
///
/// # Errors
/// The value is not finite, or its size is above the range.
pub fn bounded(key: &str, value: f64, unit: &str) -> Result<f64> {
    if value.abs() <= LARGEST {
        return Ok(value);
    }
    Err(Error::expected(key, format!("a number of at most {LARGEST:e} {unit} in size"), format!("{value:?}")))
}

/// Checks the components of a vector or the values of a field together: all must be finite, and either all are zero or
/// the largest size is within the range. A small component beside a large one is allowed.
///
/// # Errors
/// A value is not finite or is too large, or all are too small.
pub fn largest(key: &str, values: impl IntoIterator<Item = f64>, unit: &str) -> Result<()> {
    let mut found = 0.0f64;
    for value in values {
        // The negated comparison is also true for NaN.
        if !(value.abs() <= found.abs()) {
            found = value;
        }
        if !(found.abs() <= LARGEST) {
            break;
        }
    }
    if found == 0.0 || contains(found.abs()) {
        return Ok(());
    }
    let expected = if found.abs() < LEAST { "all zero or the largest at least" } else { "at most" };
    let bound = if found.abs() < LEAST { LEAST } else { LARGEST };
    let problem = format!("finite numbers of {unit}, {expected} {bound:e} in size");
    Err(Error::expected(key, problem, format!("{found:?}")))
}

//! The range of the physical quantities that an input may have.
//!
//! Within it the products and squares that energies and their gradients are made of stay in the range of numbers.

use crate::error::{Error, Result};

/// The least size of a quantity other than zero, in its SI unit.
pub const LEAST: f64 = 1e-30;
/// The largest size of a quantity, in its SI unit.
pub const LARGEST: f64 = 1e30;

/// Whether a positive quantity is within the range.
pub fn contains(value: f64) -> bool {
    (LEAST..=LARGEST).contains(&value)
}

/// A quantity above zero, in `unit`, such as `Pa` or `metres per mesh unit`.
///
/// # Errors
/// It is not above zero, or outside the range.
pub fn positive(key: &str, value: f64, unit: &str) -> Result<f64> {
    match value {
        v if contains(v) => Ok(v),
        v if !(v > 0.0 && v.is_finite()) => Err(Error::expected(key, format!("a positive number of {unit}"), v)),
        v => Err(Error::expected(key, format!("a number from {LEAST:e} to {LARGEST:e} {unit}"), format!("{v:?}"))),
    }
}

/// A quantity of zero or more, in `unit`.
///
/// # Errors
/// It is below zero, or outside the range.
pub fn not_negative(key: &str, value: f64, unit: &str) -> Result<f64> {
    if value == 0.0 || contains(value) {
        return Ok(value);
    }
    let expected = format!("0 or a number from {LEAST:e} to {LARGEST:e} {unit}");
    Err(Error::expected(key, expected, format!("{value:?}")))
}

/// A quantity of either sign, such as a coordinate, in `unit`.
///
/// # Errors
/// It is not finite, or its size is above the range.
pub fn bounded(key: &str, value: f64, unit: &str) -> Result<f64> {
    if value.abs() <= LARGEST {
        return Ok(value);
    }
    Err(Error::expected(key, format!("a number of at most {LARGEST:e} {unit} in size"), format!("{value:?}")))
}

/// That the components of a vector or the values of a field, in `unit`, are finite, and that they are all zero or the largest is
/// within the range. A small component beside a large one is allowed.
///
/// # Errors
/// A value is not finite or too large, or all are too small.
pub fn largest(key: &str, values: impl IntoIterator<Item = f64>, unit: &str) -> Result<()> {
    let mut found = 0.0f64;
    for value in values {
        // Also where it is not a number.
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

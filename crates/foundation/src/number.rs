//! Numbers from outside. JSON has neither infinities nor NaN, for which null stands; arrays may have any.

use serde::{Deserialize, Deserializer};

/// The number where it is finite.
pub fn finite(value: f64) -> Option<f64> {
    Some(value).filter(|value| value.is_finite())
}

/// Reads a number that may be null, which becomes NaN. Serde writes NaN as null.
///
/// # Errors
/// It is neither a number nor null.
pub fn or_nan<'de, D: Deserializer<'de>>(source: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(source)?.unwrap_or(f64::NAN))
}

/// Reads a list of numbers that may be null, as [`or_nan`] reads one.
///
/// # Errors
/// An entry is neither a number nor null.
pub fn each_or_nan<'de, D: Deserializer<'de>>(source: D) -> Result<Vec<f64>, D::Error> {
    let all: Vec<Option<f64>> = Deserialize::deserialize(source)?;
    Ok(all.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect())
}

/// Whole numbers as places from 0.
///
/// # Errors
/// The first number below zero.
pub fn places(numbers: Vec<i64>) -> Result<Vec<usize>, i64> {
    numbers.into_iter().map(|number| usize::try_from(number).map_err(|_| number)).collect()
}

/// The place of the first value that is infinite or not a number.
pub fn first_not_finite(values: &[f64]) -> Option<usize> {
    values.iter().position(|value| !value.is_finite())
}

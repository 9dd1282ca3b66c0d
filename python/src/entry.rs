//! The keys of a `[[fit]]` as arguments.

use crate::error::invalid;
use crate::value::{inline, table};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springfit_studies::study::FitEntry;
use toml::Value;

/// The entry that has these keys.
///
/// # Errors
/// A key that all fits have is of another type; those of one objective are checked with it.
pub fn fit_entry(py: Python, keys: &Bound<PyDict>) -> PyResult<FitEntry> {
    let mut keys = table(keys, "keys")?;
    let mut text = |key: &str, expected: &str| match keys.remove(key) {
        Some(Value::String(text)) => Ok(Some(text)),
        Some(other) => Err(invalid(py, key, expected, inline(&other))),
        None => Ok(None),
    };
    let expected = "the name of an objective";
    let objective = text("objective", expected)?.ok_or_else(|| invalid(py, "objective", expected, "none"))?;
    let name = text("name", "a text")?;
    let springs = match keys.remove("springs") {
        None => None,
        // A word stands for groups of any element, as in scenes.
        Some(Value::String(one)) => Some(vec![one]),
        Some(given) => {
            let names =
                given.as_array().map(|names| names.iter().map(|name| name.as_str().map(String::from)).collect());
            let expected = "a name of a spring group, such as \"all + volume\", or a list of them";
            Some(names.flatten().ok_or_else(|| invalid(py, "springs", expected, inline(&given)))?)
        }
    };
    let mut entry = FitEntry::new(objective).with_springs(springs);
    entry.name = name;
    Ok(keys.into_iter().fold(entry, |entry, (key, value)| entry.with(&key, Some(value))))
}

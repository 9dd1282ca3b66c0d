//! Values of keys that can be written in more than one way.

use crate::error::{Error, Result};

/// A number.
pub fn number(value: &toml::Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|i| i as f64))
}

/// Two numbers.
pub fn pair(value: &toml::Value) -> Option<[f64; 2]> {
    let numbers: Option<Vec<f64>> = value.as_array()?.iter().map(number).collect();
    numbers?.try_into().ok()
}

/// A value in an error.
pub fn shown(value: &toml::Value) -> String {
    match (value, number(value)) {
        (_, Some(number)) => number.to_string(),
        (toml::Value::String(text), _) => format!("\"{text}\""),
        (toml::Value::Array(items), _) => format!("[{}]", items.iter().map(shown).collect::<Vec<_>>().join(", ")),
        _ => format!("a {}", value.type_str()),
    }
}

/// The numbers of lists inside each other.
///
/// # Errors
/// A value in them is no finite number.
pub fn flat(key: &str, value: &toml::Value, numbers: &mut Vec<f64>) -> Result<()> {
    match value.as_array() {
        Some(items) => items.iter().enumerate().try_for_each(|(i, item)| flat(&format!("{key}[{i}]"), item, numbers)),
        None => {
            let found = number(value).filter(|number| number.is_finite());
            numbers.push(found.ok_or_else(|| Error::expected(key, "finite numbers", shown(value)))?);
            Ok(())
        }
    }
}

/// Numbers separated by commas, spaces and line ends; `#` begins a comment.
///
/// # Errors
/// A word is no finite number; the error has its line.
pub fn numbers_of(text: &str) -> Result<Vec<f64>> {
    let mut numbers = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        for word in line.split(|c: char| c == ',' || c == ';' || c.is_whitespace()).filter(|word| !word.is_empty()) {
            let number = word.parse().ok().filter(|v: &f64| v.is_finite());
            numbers.push(
                number.ok_or_else(|| Error::new(format!("expected finite numbers, found {word}")).on_line(i + 1))?,
            );
        }
    }
    Ok(numbers)
}

//! Keys whose values are names of a closed list.

use crate::error::Result;

/// The value with this name, or the default if the key is not given.
///
/// # Errors
/// There is no such name; the error has the key `key`.
pub fn choice<T>(key: &str, name: Option<&str>, default: T, named: fn(&str) -> Result<T>) -> Result<T> {
    name.map_or(Ok(default), named).map_err(|e| e.under(key))
}

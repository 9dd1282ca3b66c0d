//! Names that must differ.

use crate::error::{Error, Result};

/// The name of the finite elements among the models of a scene.
pub const BODY: &str = "finite elements";
/// The name of quadratic elements on the cells of a mesh that lock.
pub const QUADRATIC: &str = "quadratic elements";

/// Checks that `name` is not among `others`.
///
/// # Errors
/// It is; the error has the key `key`.
pub fn expect_own_name<'a>(key: &str, name: &str, mut others: impl Iterator<Item = &'a str>) -> Result<()> {
    match others.any(|other| other == name) {
        true => Err(Error::expected(key, "a name of its own", format!("\"{name}\" again"))),
        false => Ok(()),
    }
}

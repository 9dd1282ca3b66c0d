//! The facts of a scene that a fit may require.

use crate::error::Result;
use crate::named::unknown;

/// The facts of a scene that a fit may require.
#[derive(Debug, Clone, Copy)]
pub struct SceneFacts<'a> {
    /// Whether the material has a law, so that deformations are large.
    pub law: bool,
    /// Whether the material has a density.
    pub density: bool,
    /// The names of the loads.
    pub loads: &'a [&'a str],
}

impl SceneFacts<'_> {
    /// Checks that these loads are in the scene.
    ///
    /// # Errors
    /// A load is not; the error has the key `key`.
    pub fn expect_loads(&self, key: &str, names: &[String]) -> Result<()> {
        match names.iter().find(|name| !self.loads.contains(&name.as_str())) {
            Some(name) => {
                let expected = format!("loads of the scene ({})", self.loads.join(", "));
                Err(unknown(expected, self.loads.iter().copied(), name).at_key(key))
            }
            None => Ok(()),
        }
    }
}

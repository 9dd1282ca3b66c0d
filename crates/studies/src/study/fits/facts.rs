//! What a fit may need of its scene.

use crate::error::Result;
use crate::named::unknown;

/// The parts of a scene that a fit may need.
#[derive(Debug, Clone, Copy)]
pub struct SceneFacts<'a> {
    /// Whether the material has a law, so that deformations are large.
    pub law: bool,
    pub density: bool,
    /// Names.
    pub loads: &'a [&'a str],
}

impl SceneFacts<'_> {
    /// That these loads are in the scene.
    ///
    /// # Errors
    /// One is not; the key is `key`.
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

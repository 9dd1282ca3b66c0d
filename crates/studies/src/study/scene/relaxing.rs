//! Whether the material of a scene relaxes.

use super::document::Scene;
use crate::material::Relaxation;

impl Scene {
    /// How the moduli relax, if they do, with the key that says so.
    pub fn relaxation(&self) -> Option<(String, Relaxation)> {
        // It has been checked.
        let checked = self.material.first().relaxation.as_ref()?.check().ok()?;
        Some((format!("{}.relaxation", self.material.key(0)), checked))
    }
}

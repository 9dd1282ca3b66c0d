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

    /// What must be known of the relaxation, if there is one.
    pub fn relaxation_note(&self) -> Option<String> {
        let entry = self.material.first().relaxation.as_ref()?;
        let fitted = entry.fitted().map_or(String::new(), |series| {
            let count = series.terms.len();
            format!(
                "; the measured moduli have a Prony series of {count} terms with an error of {:.2} % (root mean square) and {:.4e} Pa against a sudden strain, of \
                 which shares alone are used",
                100.0 * series.error,
                series.modulus
            )
        });
        Some(format!(
            "the material relaxes in [motion] alone: loads, frequencies and networks that are written have the moduli against a sudden strain{fitted}"
        ))
    }
}

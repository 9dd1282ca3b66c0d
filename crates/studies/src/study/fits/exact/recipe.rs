//! An exact network before the material is known.

use crate::error::{Error, ErrorKind, Result};
use crate::fit::{ExactEnergy, ExactFit, VolumeSprings};
use crate::material::Energy;

/// An exact network before the material is known.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ExactRecipe {
    /// That of the material's law, or the stable neo-Hookean one where it has none, if absent.
    pub energy: Option<ExactEnergy>,
    pub volume: VolumeSprings,
}

impl ExactRecipe {
    /// The network of a body whose material has this law, if it has one.
    ///
    /// # Errors
    /// The law is no energy of springs and no other is named.
    pub fn resolve(&self, law: Option<&Energy>) -> Result<ExactFit> {
        let of_law = |law: &Energy| {
            ExactEnergy::of_law(law).ok_or_else(|| {
                let names = ExactEnergy::NAMES.join("\", \"");
                let expected =
                    format!("a law that is \"{names}\", with fibres or without, or one of these as the key \"energy\"");
                Error::expected("objective", expected, format!("\"{}\"", law.name)).of_kind(ErrorKind::Unsupported)
            })
        };
        let energy = match (self.energy, law) {
            (Some(energy), _) => energy,
            (None, Some(law)) => of_law(law)?,
            (None, None) => ExactEnergy::default(),
        };
        Ok(ExactFit { energy, volume: self.volume, large: law.is_some() })
    }
}

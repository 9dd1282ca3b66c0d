//! An exact network before the material is known.

use crate::error::{Error, ErrorKind, Result};
use crate::fit::{ExactEnergy, ExactFit, VolumeSprings};
use crate::positive::PositiveFit;

/// An exact network before the material is known.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ExactRecipe {
    /// That of the material's law, or the stable neo-Hookean one where it has none, if absent.
    pub energy: Option<ExactEnergy>,
    pub volume: VolumeSprings,
    /// The nearest network without negative springs instead.
    pub positive: Option<PositiveFit>,
}

impl ExactRecipe {
    /// The network of a body whose material has this law, if it has one.
    ///
    /// # Errors
    /// The law is no energy of springs and no other is named.
    pub fn resolve(&self, law: Option<&str>) -> Result<ExactFit> {
        let of_law = |law: &str| {
            ExactEnergy::named(law).map_err(|_| {
                let names = ExactEnergy::NAMES.join("\" or \"");
                let expected =
                    format!("a material with the law \"{names}\", or one of them as the key \"energy\" of the fit");
                Error::expected("objective", expected, format!("the law \"{law}\"")).of_kind(ErrorKind::Unsupported)
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

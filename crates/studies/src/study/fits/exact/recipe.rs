//! An exact network before the material is known.

use crate::error::{Error, ErrorKind, Result};
use crate::fit::{ExactEnergy, ExactFit, VolumeSprings, fit_exact};
use crate::material::{Energy, Material};
use crate::mesh::{CellBlock, Mesh};
use crate::model::patch_springs;
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

    /// Whether a body of this material and law has the network. The first cell of each block answers for all; patches are made.
    pub fn serves(&self, law: Option<&Energy>, mesh: &Mesh, material: Material) -> bool {
        let Ok(fit) = self.resolve(law) else { return false };
        let block = |block: &CellBlock| {
            let cell = &block.connectivity[..block.element.nodes()];
            fit_exact(&block.element, &mesh.points, cell, material, &fit, &mut |_| {}).is_ok()
        };
        let patches = fit.volume == VolumeSprings::Patches;
        mesh.blocks.iter().all(block) && (!patches || patch_springs(mesh, material, &fit, &[]).is_ok())
    }
}

//! An exact network, before the material is known.

use crate::error::{Error, ErrorKind, Result};
use crate::fit::{ExactEnergy, ExactFit, ShearSprings, VolumeSprings, fit_exact};
use crate::material::{Energy, EnergyMap, MaterialMap};
use crate::mesh::{CellBlock, Mesh};
use crate::model::{has_edge_springs, has_strains, patch_springs};
use crate::positive::PositiveFit;

/// The settings of an exact network, before the material is known.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ExactRecipe {
    /// The energy; if absent that of the material's law, or the stable neo-Hookean one if the material has no law.
    pub energy: Option<ExactEnergy>,
    /// The domains over which shear springs average the deformation.
    pub shear: ShearSprings,
    /// The contents that volume springs measure.
    pub volume: VolumeSprings,
    /// The settings of the nearest network without negative springs, if it is requested.
    pub positive: Option<PositiveFit>,
}

/// The springs for μ and λ in the name of an exact network; those that are usual are not named.
pub fn spring_words(shear: ShearSprings, volume: VolumeSprings) -> String {
    let shear = match shear {
        ShearSprings::Cells => String::new(),
        ShearSprings::Edges => format!(" {}", shear.name()),
    };
    match volume {
        VolumeSprings::Points => shear,
        VolumeSprings::Cells | VolumeSprings::Patches => format!("{shear} {}", volume.name()),
    }
}

impl ExactRecipe {
    /// The exact network of a body with these laws, if the material has some.
    ///
    /// # Errors
    /// A law is not an energy of springs, and no other energy is named; or the laws of two regions are two energies.
    pub fn resolve_all(&self, laws: Option<&EnergyMap>) -> Result<ExactFit> {
        let Some(laws) = laws else { return self.resolve(None) };
        let first = self.resolve(Some(laws.first()))?;
        // A share of the second invariant that was found from other moduli differs by rounding.
        let is_another = |law: &&Energy| self.energy.is_none() && !first.energy.is_that_of(law);
        if let Some(law) = laws.laws().find(is_another) {
            let other = self.resolve(Some(law))?;
            let expected = "one energy of springs in all cells";
            let found = format!("\"{}\" and \"{}\"", first.energy.name(), other.energy.name());
            return Err(Error::expected("objective", expected, found).of_kind(ErrorKind::Unsupported));
        }
        Ok(first)
    }

    /// The exact network of this mesh with these laws, if the material has some: springs on strains have one energy.
    ///
    /// # Errors
    /// Those of [`ExactRecipe::resolve_all`].
    pub fn resolve_on(&self, mesh: &Mesh, laws: Option<&EnergyMap>) -> Result<ExactFit> {
        let fit = self.resolve_all(laws)?;
        let is_free = self.energy.is_none() && laws.is_none();
        let has_strains = self.shear == ShearSprings::Edges && has_strains(mesh);
        Ok(if is_free && has_strains { ExactFit { energy: ExactEnergy::StVenantKirchhoff, ..fit } } else { fit })
    }

    /// The exact network of a body with this law, if the material has one.
    ///
    /// # Errors
    /// The law is not an energy of springs, and no other energy is named.
    pub fn resolve(&self, law: Option<&Energy>) -> Result<ExactFit> {
        let of_law = |law: &Energy| {
            let found = ExactEnergy::of_law(law);
            // Only domains of edges have springs on strains.
            let is_known = |energy: &ExactEnergy| self.shear == ShearSprings::Edges || energy.has_contents().is_ok();
            found.filter(is_known).ok_or_else(|| {
                let names = ExactEnergy::of_contents().join("\", \"");
                let expected =
                    format!("a law that is \"{names}\", with fibres or without, or one of these as the key \"energy\"");
                Error::expected("objective", expected, format!("\"{}\"", law.name())).of_kind(ErrorKind::Unsupported)
            })
        };
        let energy = match (self.energy, law) {
            (Some(energy), _) => energy,
            (None, Some(law)) => of_law(law)?,
            (None, None) => ExactEnergy::default(),
        };
        Ok(ExactFit { energy, shear: self.shear, volume: self.volume, large: law.is_some() })
    }

    /// Whether a body with this material and law has the network. The first cell of each block is tried for all cells;
    /// patches are constructed.
    pub fn serves(&self, laws: Option<&EnergyMap>, mesh: &Mesh, material: &MaterialMap) -> bool {
        let Ok(fit) = self.resolve_on(mesh, laws) else { return false };
        let block = |(index, block): (usize, &CellBlock)| {
            let Ok(materials) = material.materials() else { return false };
            let material = *materials.at(index, 0);
            let cell = &block.connectivity[..block.element.nodes()];
            fit_exact(&block.element, &mesh.points, cell, material, &fit, &mut |_| {}).is_ok()
        };
        let patches = fit.volume == VolumeSprings::Patches;
        let shear = match fit.shear {
            ShearSprings::Cells => mesh.blocks.iter().enumerate().all(block),
            ShearSprings::Edges => has_edge_springs(mesh, material, &fit),
        };
        shear && (!patches || patch_springs(mesh, material, &fit, &[]).is_ok())
    }
}
